// SPDX-License-Identifier: BSD-3-Clause
#include "shared/program.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <span>
#include <sstream>

#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/simd_target.h"
#include "keepout/version.h"
#include "shared/command_line.h"
#include "shared/completion.h"
#include "shared/documentation.h"
#include "shared/manual.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

// The exit status after a wrong command line. `keepout --help` names it.
constexpr int exit_usage = 2;

constexpr const char* run_help =
    "\nThe experiments of the paper, done again: ./run experiments, and with --full all of them.\n";

constexpr const char* exit_statuses =
    "Exit status: 0 if all went well; 1 if something failed, or what was to be checked does not "
    "hold;\n"
    "2 if the command line is wrong; 130 if it was interrupted: bench, compare, plan, replay, "
    "simulate\nand verify then keep what was finished.\n";

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

/// True once a write to a pipe failed because the reader has closed it.
volatile std::sig_atomic_t reader_is_gone = 0;

/// Lets a command finish its files if the reader of its output ends early, as `head` does.
void outlive_readers() {
  struct sigaction action = {};
  if (::sigaction(SIGPIPE, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) return;
  action.sa_handler = [](int) { reader_is_gone = 1; };
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGPIPE, &action, nullptr);
}

/// Returns the exit status, or failure if the output has lost its reader. Throws Error if what was
/// printed could not be written: a full disk must not look like success.
int flushed(int status) {
  std::cout.flush();
  if (std::cout) return status;
  if (reader_is_gone != 0) return status == EXIT_SUCCESS ? EXIT_FAILURE : status;
  throw Error("stdout: could not be written to the end; is the disk full?");
}

/// Returns the name by which the user calls the program: ./run puts its own in the place of ours.
std::string called_as(const char* path) {
  return std::filesystem::path(path).filename() == "run" ? "./run" : "keepout";
}

std::vector<CLI::App*> subcommands(CLI::App& app) {
  return app.get_subcommands([](CLI::App*) { return true; });
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

/// Adds the options of the program, all commands, and the options that every command has.
void set_up(CLI::App& app, const std::vector<Command>& commands) {
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  const bool is_run = app.get_name() == "./run";
  app.footer(mesh_names_help() + (is_run ? run_help : "") + '\n' + exit_statuses);
  app.set_version_flag("-V,--version", KEEPOUT_VERSION);
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
  const auto add_quiet = [](CLI::App& to) {
    to.add_flag_callback("-q,--quiet", be_quiet,
                         "Print no progress and no notices: only results, warnings and errors");
  };
  add_quiet(app);
  for (CLI::App* command : subcommands(app)) {
    for (CLI::Option* option : command->get_options()) {
      if (option->get_items_expected_max() > 0) option->check(not_empty());
    }
    add_quiet(*command);
  }
  app.add_subcommand("help", "Print this help, or that of a command")
      ->group("Commands")
      ->add_option("COMMAND", "The command")
      ->type_name("");
}

/// Runs `help`. Returns the exit status.
int help(CLI::App& app) {
  const CLI::Option& named = *app.get_subcommand("help")->get_option("COMMAND");
  const std::string name = named.empty() ? "" : named.as<std::string>();
  CLI::App* command = &app;
  if (!name.empty()) {
    const std::vector<CLI::App*> all = subcommands(app);
    const auto found = std::ranges::find(all, name, [](CLI::App* one) { return one->get_name(); });
    if (found == all.end()) {
      std::cerr << "keepout: " << unknown_command(app, name) << '\n';
      return exit_usage;
    }
    command = *found;
  }
  const std::string prefix = command == &app ? "" : app.get_name() + " ";
  std::cout << with_places_of_pages(app.get_formatter()->make_help(
      command, prefix + command->get_name(), CLI::AppFormatMode::Normal));
  return EXIT_SUCCESS;
}

int run(const std::vector<Command>& commands, int argc, char** argv) {
  CLI::App app("keepout keeps a tool out of a triangle mesh of anatomy. All lengths are in mm.",
               called_as(argv[0]));
  set_up(app, commands);
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (print_for_files(app, words)) return EXIT_SUCCESS;
  try {
    app.parse(argc, argv);
    refuse_empty_items(*app.get_subcommands().front(), words);
  } catch (const CLI::Success& call_for_help) {
    // CLI11 prints the help of the program although the command is mistyped.
    const std::vector<std::string> extra = app.remaining();
    if (app.get_subcommands().empty() && !extra.empty() && !extra.front().starts_with('-')) {
      std::cerr << "keepout: " << unknown_command(app, extra.front()) << '\n';
      return exit_usage;
    }
    std::ostringstream text;
    const int status = app.exit(call_for_help, text, text);
    std::cout << with_places_of_pages(text.str());
    return status;
  } catch (const CLI::ParseError& error) {
    std::cerr << "keepout: " << usage_error(app, error) << '\n';
    return exit_usage;
  }
  if (app.got_subcommand("help")) return help(app);
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
  outlive_readers();
  int status = EXIT_FAILURE;
  try {
    status = flushed(run(commands, argc, argv));
  } catch (const PreparationInterrupted&) {
    status = exit_interrupted;  // fixture_path() has said so
  } catch (const Error& error) {
    std::cerr << "keepout: " << error.what() << '\n';
  } catch (const std::bad_alloc&) {
    std::cerr << "keepout: out of memory; is the mesh larger than this machine can hold?\n";
  } catch (const std::exception& error) {
    std::cerr << "keepout: unexpected: " << error.what() << '\n';
  }
  if (has_left_work_behind) std::_Exit(status);
  return status;
}

}  // namespace keepout::app
