// SPDX-License-Identifier: BSD-3-Clause
// The program that libFuzzer drives. The environment variable KEEPOUT_HARNESS names the harness;
// without it the program lists all harnesses, for tests/fuzz/run.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "fuzz/harness.h"

namespace {

keepout::fuzz::Harness chosen;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* const named = std::getenv("KEEPOUT_HARNESS");
  const auto all = keepout::fuzz::harnesses();
  const std::string_view name = named == nullptr ? "" : named;
  const auto found = std::ranges::find(all, name, &keepout::fuzz::Harness::name);
  if (found == all.end()) {
    for (const auto& harness : all) {
      std::printf("%s\t%s\n", harness.name.data(), harness.sources.data());
    }
    std::exit(name.empty() ? EXIT_SUCCESS : EXIT_FAILURE);
  }
  chosen = *found;
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  chosen.run({data, size});  // an exception ends the program, which libFuzzer reports
  return 0;
}
