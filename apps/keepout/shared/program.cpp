// SPDX-License-Identifier: BSD-3-Clause
#include "shared/program.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>
#include <span>
#include <sstream>

#include "keepout/error.h"
#include "keepout/simd_target.h"
#include "keepout/version.h"
#include "shared/command_line.h"
#include "shared/completion.h"
#include "shared/documentation.h"
#include "shared/manual.h"
#include "shared/named_mesh.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

// The exit status after a wrong command line. `keepout --help` names it.
constexpr int exit_usage = 2;

/// A command of ./run that is no command of this program.
constexpr const char* also_run =
    "\nThe experiments of the paper, done again: ./run experiments, and with --full all of them.\n";

constexpr const char* exit_statuses =
    "Exit status: 0 if all went well; 1 if something failed, or what was to be checked does not "
    "hold;\n"
    "2 if the command line is wrong; 130 if it was interrupted: bench, compare, plan and verify "
    "then "
    "keep\nwhat was finished.\n";

/// Makes writing beyond a limit on the size of files fail, instead of ending the process. Opens
/// stdin, stdout and stderr where they are closed, so that reading and writing fail there:
/// otherwise the next file that is opened would be taken for one of them.
void prepare_process() {
  ::signal(SIGXFSZ, SIG_IGN);
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(file, F_GETFD) >= 0) continue;
    ::open("/dev/null", file == STDIN_FILENO ? O_WRONLY : O_RDONLY);  // gets the lowest number
  }
}

/// Throws Error if what was printed could not be written: a full disk shall not look like success.
void flush_stdout() {
  std::cout.flush();
  if (!std::cout) throw Error("stdout: could not be written to the end; is the disk full?");
}

/// Returns the name by which the user calls the program: ./run puts its own in the place of ours.
std::string called_as(const char* path) {
  return std::filesystem::path(path).filename() == "run" ? "./run" : "keepout";
}

/// Prints what installed files ask for: completions and the manual page. Returns false if the words
/// ask for neither.
bool print_for_files(CLI::App& app, const std::vector<std::string>& words) {
  const std::string first = words.empty() ? "" : words.front();
  if (first == "--complete") {
    print_completions(app, std::span(words).subspan(1), std::cout);
  } else if (first == "--manual") {
    // The reader's processor has other instruction sets than this one.
    app.get_option("--simd")->option_text("TARGET");
    print_manual(app, std::cout);
  } else {
    return false;
  }
  return true;
}

int run(const std::vector<Command>& commands, int argc, char** argv) {
  CLI::App app("keepout keeps a tool out of a triangle mesh of anatomy. All lengths are in mm.",
               called_as(argv[0]));
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  const bool is_run = app.get_name() == "./run";
  app.footer(mesh_names_help() + (is_run ? also_run : "") + '\n' + exit_statuses);
  app.set_version_flag("--version", KEEPOUT_VERSION);
  app.set_help_all_flag("--help-all", "Help on every command");
  app.require_subcommand(1);
  const std::vector<std::string_view> targets = simd_targets();
  app.add_option_function<std::string>("--simd", use_simd_target,
                                       "Instruction set to run on instead of the fastest that this "
                                       "processor has; the steps are the same")
      ->check(one_of({targets.begin(), targets.end()}))
      ->default_str(std::string(simd_target()))
      ->type_name("TARGET");
  for (const Command& command : commands) {
    command.add(app);
    app.get_subcommand(std::string(command.name))->group(std::string(command.group));
  }
  if (print_for_files(app, {argv + 1, argv + argc})) return EXIT_SUCCESS;
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& call_for_help) {
    std::ostringstream text;
    const int status = app.exit(call_for_help, text, text);
    std::cout << with_places_of_pages(text.str());
    return status;
  } catch (const CLI::ParseError& error) {
    std::cerr << "keepout: " << usage_error(app, error) << '\n';
    return exit_usage;
  }
  Call call{app.get_name(), "keepout"};
  for (int i = 1; i < argc; ++i) call.command += " " + shell_word(argv[i]);
  const auto chosen = std::ranges::find_if(commands, [&](const Command& command) {
    return app.got_subcommand(std::string(command.name));
  });
  return chosen->run(call);
}

}  // namespace

int run_program(const std::vector<Command>& commands, int argc, char** argv) {
  prepare_process();
  try {
    const int status = run(commands, argc, argv);
    flush_stdout();
    return status;
  } catch (const Error& error) {
    std::cerr << "keepout: " << error.what() << '\n';
  } catch (const std::bad_alloc&) {
    std::cerr << "keepout: out of memory; is the mesh larger than this machine can hold?\n";
  } catch (const std::exception& error) {
    std::cerr << "keepout: unexpected: " << error.what() << '\n';
  }
  return EXIT_FAILURE;
}

}  // namespace keepout::app
