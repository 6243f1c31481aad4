// SPDX-License-Identifier: BSD-3-Clause
#include "shared/manual.h"

#include <CLI/CLI.hpp>
#include <ostream>
#include <sstream>

#include "keepout/version.h"

namespace keepout::app {
namespace {

/// Returns the text with every character escaped that man would read as a request.
std::string as_roff(const std::string& text) {
  std::string result;
  bool at_start = true;
  for (const char c : text) {
    if (at_start && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
    at_start = c == '\n';
  }
  return result;
}

/// Prints lines unformatted.
void print_lines(const std::string& text, std::ostream& out) {
  if (text.empty()) return;
  out << ".PP\n.nf\n" << as_roff(text) << (text.ends_with('\n') ? "" : "\n") << ".fi\n";
}

/// Prints the options of a program, or those options of a command that the program does not have.
void print_options(const CLI::App& command, std::ostream& out) {
  const CLI::Formatter formatter;
  const CLI::App* const program = command.get_parent();
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;  // hidden from users
    if (program != nullptr && program->get_option_no_throw(option->get_name()) != nullptr) continue;
    const bool is_positional = option->get_positional();
    std::string values = formatter.make_option_opts(option);
    CLI::detail::trim(values);
    if (values.starts_with(':')) values.erase(0, 1);  // a type without a name
    out << ".TP\n.B " << as_roff(formatter.make_option_name(option, is_positional)) << '\n';
    if (!values.empty()) out << as_roff(values) << "\n.br\n";
    out << as_roff(formatter.make_option_desc(option)) << '\n';
  }
}

std::string synopsis_of(const CLI::App& command) {
  std::string text = command.get_name() + " [OPTIONS]";
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) text += " " + CLI::Formatter().make_option_usage(option);
  }
  return text;
}

std::string capitals(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

void print_manual(const CLI::App& app, std::ostream& out) {
  const std::string name = app.get_name();
  std::istringstream description(app.get_description());
  std::string verb, what;
  description >> verb;  // the name of the program, which begins the sentence
  std::getline(description >> std::ws, what, '.');
  out << ".TH " << capitals(name) << " 1 \"\" \"" << name << ' ' << KEEPOUT_VERSION
      << "\" \"User Commands\"\n.SH NAME\n"
      << as_roff(name) << " \\- " << as_roff(what) << "\n.SH SYNOPSIS\n.B " << as_roff(name)
      << "\n[OPTIONS] COMMAND [OPTIONS] [ARGUMENTS]\n.SH DESCRIPTION\n"
      << as_roff(app.get_description()) << '\n';
  print_lines(app.get_footer(), out);
  out << ".SH OPTIONS\n";
  print_options(app, out);
  std::string group;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_group().empty()) continue;
    if (command->get_group() != group)
      out << ".SH " << capitals(group = command->get_group()) << '\n';
    out << ".SS " << as_roff(name + " " + synopsis_of(*command)) << '\n'
        << as_roff(command->get_description()) << '\n';
    print_options(*command, out);
    if (command->get_footer() != app.get_footer()) print_lines(command->get_footer(), out);
  }
  out << ".SH SEE ALSO\n.B keepout docs\nprints where the pages of documentation are, such as "
         "docs/getting_started.md.\n";
}

}  // namespace keepout::app
