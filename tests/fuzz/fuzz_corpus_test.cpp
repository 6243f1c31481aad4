// SPDX-License-Identifier: BSD-3-Clause
// Passes the files of the corpus to the harnesses, so that the harnesses stay usable without
// libFuzzer, and what it found once stays mended.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <ostream>

#include "fuzz/harness.h"
#include "messages.h"

namespace keepout::fuzz {

void PrintTo(const Harness& harness, std::ostream* out) { *out << harness.name; }

namespace {

namespace fs = std::filesystem;

const fs::path corpus = KEEPOUT_FUZZ_CORPUS;

class FuzzCorpus : public testing::TestWithParam<Harness> {};

TEST_P(FuzzCorpus, HasNoFinding) {
  const Harness& harness = GetParam();
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(corpus / harness.name)) {
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  ASSERT_FALSE(files.empty());
  EXPECT_NO_THROW(harness.run({})) << "no bytes";
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::vector<char> contents(std::istreambuf_iterator<char>(in), {});
    // A copy of the exact size: sanitizers notice each access beyond it.
    const std::vector<std::uint8_t> bytes(contents.begin(), contents.end());
    EXPECT_NO_THROW(harness.run(bytes)) << file;
  }
}

TEST(FuzzCorpus, HasAFolderForEachHarness) {
  const auto all = harnesses();
  for (const auto& entry : fs::directory_iterator(corpus)) {
    EXPECT_NE(std::ranges::find(all, entry.path().filename().string(), &Harness::name), all.end())
        << entry.path();
  }
}

INSTANTIATE_TEST_SUITE_P(Harnesses, FuzzCorpus, testing::ValuesIn(harnesses()),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace keepout::fuzz
