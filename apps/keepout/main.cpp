// SPDX-License-Identifier: BSD-3-Clause
// Commands that compare are those of another program, keepout-bench, which is installed beside this
// one by those who want it: it links planners and other libraries.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string_view>

#include "user_commands.h"

namespace {

/// Commands that compare belong to another program, keepout-bench, which links planners and other
/// libraries. It is optional, and installed beside this program.
std::string_view word_of(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "--complete") return {};
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--simd") ++i;
    if (!argument.starts_with("-")) return argument;
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<keepout::app::Command> commands = keepout::app::user_commands();
  const std::string_view word = word_of(argc, argv);
  const bool is_own = std::ranges::any_of(
      commands, [&](const keepout::app::Command& command) { return command.name == word; });
  const bool times_parts =
      word == "simulate" && std::any_of(argv, argv + argc, [](const char* text) {
        return std::string_view(text) == "--bench";
      });
  if (!is_own || times_parts) {
    std::error_code error;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
    execv((self.parent_path() / "keepout-bench").c_str(), argv);
    // keepout-bench is not installed here.
    if (word == "bench" || word == "compare" || word == "plan" || times_parts) {
      std::cerr << "keepout: '" << (times_parts ? "simulate --bench" : word)
                << "' needs the program keepout-bench beside this one: install the package of that "
                   "name, or call ./run in the sources\n";
      return EXIT_FAILURE;
    }
  }
  return keepout::app::run_program(commands, argc, argv);
}
