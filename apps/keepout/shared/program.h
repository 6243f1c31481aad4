// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace keepout::app {

/// How a user called a program.
struct Call {
  std::string program;  // as the user calls it: "keepout" or "./run"
  std::string command;  // the whole command line, for records
};

/// A command of a program.
struct Command {
  std::string_view name;
  std::function<void(CLI::App& app)> add;    // adds the command and its options to a command line
  std::function<int(const Call& call)> run;  // runs it; returns the exit status
  std::string_view group = "Commands";       // the heading of its list in help and manual
};

/// Returns the command of this name; its options are an Options. `run` takes the options and the
/// stream of results, and returns the exit status or nothing.
template <class Options, class Run>
Command command(std::string_view name, void (*add)(CLI::App&, Options&), Run run,
                std::shared_ptr<Options> options = std::make_shared<Options>()) {
  return {name, [=](CLI::App& app) { add(app, *options); },
          [=](const Call& call) {
            if constexpr (requires { options->command; }) options->command = call.command;
            if constexpr (requires { options->called_as; }) options->called_as = call.program;
            if constexpr (std::is_void_v<decltype(run(*options, std::cout))>) {
              run(*options, std::cout);
              return EXIT_SUCCESS;
            } else {
              return run(*options, std::cout);
            }
          }};
}

/// Runs the command that the command line names. Returns the exit status: see `--help`. Prints
/// errors on stderr.
///
/// Two command lines are for installed files, not for users. `--complete WORD...` prints the
/// completions of the last word (completion.bash); `--manual` prints the manual page.
int run_program(const std::vector<Command>& commands, int argc, char** argv);

}  // namespace keepout::app
