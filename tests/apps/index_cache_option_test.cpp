// SPDX-License-Identifier: BSD-3-Clause
// --index-cache, as a user runs it: the results do not depend on the files in the folder.

#include <chrono>
#include <sstream>

#include "apps/command_process.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"

namespace keepout::test {
namespace {

class IndexCacheOption : public testing::Test {
 protected:
  void SetUp() override {
    write_binary_stl(folder.file("gear.stl"), make_gear(1.0));
    folder.write("poses.txt", "0 0 60 1 2 -3\n30 4 21 1 -2 -3\n49 1 0 -4 1 0\n0 45 12 0 2 -3\n");
    plain_answer = answer("");
  }

  /// Returns the results of the command, without times.
  std::string answer(const std::string& options, const std::string& index = "wide_bvh") const {
    succeeded(folder.run("replay gear.stl --poses poses.txt --out steps.csv --index " + index +
                         ' ' + options));
    std::ifstream steps(folder.file("steps.csv"));
    std::string all;
    for (std::string line; std::getline(steps, line);) {
      std::istringstream cells(line);
      int column = 0;
      for (std::string cell; column < untimed_columns && std::getline(cells, cell, ','); ++column) {
        all += cell + ',';
      }
      all += '\n';
    }
    return all;
  }

  /// Returns the files in the cache.
  std::vector<std::filesystem::path> cached() const {
    const std::filesystem::directory_iterator files(folder.file("cache"));
    return {begin(files), end(files)};
  }

  static constexpr int untimed_columns = 13;  // the other columns are t_..._ns

  CommandFolder folder;
  std::string plain_answer;
};

TEST_F(IndexCacheOption, TheFirstRunKeepsWhatTheSecondAnswersFrom) {
  ASSERT_NE(plain_answer.find("limited"), std::string::npos) << plain_answer;
  EXPECT_EQ(answer("--index-cache cache"), plain_answer);
  const auto files = cached();
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0].extension(), ".wide_bvh");

  // A file that is valid is read, and not written again.
  const auto long_ago = std::filesystem::last_write_time(files[0]) - std::chrono::hours(1);
  std::filesystem::last_write_time(files[0], long_ago);
  EXPECT_EQ(answer("--index-cache cache"), plain_answer);
  EXPECT_EQ(cached(), files);
  EXPECT_EQ(std::filesystem::last_write_time(files[0]), long_ago);
}

TEST_F(IndexCacheOption, ADamagedFileIsReplaced) {
  answer("--index-cache cache");
  ASSERT_EQ(cached().size(), 1u);
  const std::filesystem::path file = cached()[0];
  const std::string good = contents_of(file);
  ASSERT_GT(good.size(), 1000u);
  std::string changed = good;
  changed[good.size() / 2] = static_cast<char>(changed[good.size() / 2] ^ 4);
  for (const std::string& bad : {changed, good.substr(0, good.size() / 2), std::string()}) {
    std::ofstream(file, std::ios::binary) << bad;
    EXPECT_EQ(answer("--index-cache cache"), plain_answer) << bad.size();
    EXPECT_EQ(contents_of(file), good) << bad.size();
    EXPECT_EQ(cached().size(), 1u);
  }
}

TEST_F(IndexCacheOption, AFolderThatCannotBeUsedDoesNotStopTheRun) {
  folder.write("occupied", "a file where the folder should be");
  EXPECT_EQ(answer("--index-cache occupied"), plain_answer);
  EXPECT_EQ(answer("--index-cache occupied/below"), plain_answer);
  EXPECT_EQ(contents_of(folder.file("occupied")), "a file where the folder should be");
}

TEST_F(IndexCacheOption, WhatCannotBeKeptIsToldOfOnceAndWhy) {
  folder.write("occupied", "a file where the folder should be");
  const std::string replay = "replay gear.stl --poses poses.txt --out steps.csv --index-cache ";
  const ProcessOutcome no_folder = succeeded(folder.run(replay + "occupied/below"));
  EXPECT_CONTAINS(no_folder.output, "keepout: the index is not stored");
  EXPECT_CONTAINS(no_folder.output, "Not a directory");
  // A limit on the size of files stands for a full disk.
  const ProcessOutcome full =
      succeeded(folder.run(replay + "cache", "trap '' XFSZ; ulimit -f 8; "));
  EXPECT_CONTAINS(full.output, "cannot be written (File too large)");
  EXPECT_TRUE(cached().empty());
  // Each rule makes an index of its own, but the message is printed once.
  const std::string all =
      folder.run("simulate gear.stl --out r.html --strokes 1 --cycles 20 --index-cache occupied")
          .output;
  const std::size_t first = all.find("the index is not stored");
  ASSERT_NE(first, std::string::npos) << all;
  EXPECT_EQ(all.find("the index is not stored", first + 1), std::string::npos) << all;
  EXPECT_LACKS(folder.run(replay + "kept").output, "keepout:");
}

TEST_F(IndexCacheOption, OtherIndicesAreRefused) {
  const ProcessOutcome outcome = folder.run(
      "replay gear.stl --poses poses.txt --out s.csv --index pd_tree --index-cache cache");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_CONTAINS(outcome.output, "only the index wide_bvh can be stored, not 'pd_tree'");
  EXPECT_FALSE(std::filesystem::exists(folder.file("cache")));
}

}  // namespace
}  // namespace keepout::test
