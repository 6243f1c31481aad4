// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "usage_error.h"

#include <algorithm>
#include <vector>

#include "suggestion.h"

namespace keepout::app {
namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

bool is_option(const std::string& word) { return word.size() > 1 && word.front() == '-'; }

std::string unknown_command(const CLI::App& app, const std::string& word) {
  const std::vector<std::string> commands = command_names(app);
  const std::string hint = did_you_mean(word, commands);
  return "there is no command '" + word + "'" +
         (hint.empty() ? "; there are " + enumerated(commands) : hint);
}

std::string unknown_option(const CLI::App& app, const CLI::App& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  if (app.get_option_no_throw(name) != nullptr) {
    return name + " goes before the command: '" + app.get_name() + " " + name + " ... " +
           command.get_name() + "'";
  }
  return "there is no option " + name + did_you_mean(name, option_names(command));
}

/// CLI11's own words, but where they do not say enough.
std::string in_words(const CLI::App& app, const CLI::App& command, const CLI::ParseError& error) {
  const std::string told = error.what();
  const std::string kind = error.get_name();
  // A mistyped option is the likeliest reason of whatever else seems to be missing.
  const std::vector<std::string> extra = app.remaining(true);
  const auto option = std::find_if(extra.begin(), extra.end(), is_option);
  if (option != extra.end()) return unknown_option(app, command, *option);
  if (&command == &app && !extra.empty()) return unknown_command(app, extra.front());
  if (&command == &app && kind == "RequiredError") {
    return "a command is missing; there are " + enumerated(command_names(app));
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {  // whose name is the command's
    return "'" + extra.front() + "' is one argument too many for " + command.get_name();
  }
  if (kind == "RequiredError") return "an argument is missing: " + told;
  if (kind == "ArgumentMismatch") {
    // "--radius: 1 required MM missing"
    const std::size_t colon = told.find(':');
    if (colon != std::string::npos) return told.substr(0, colon) + ": a value is missing";
  }
  if (kind == "RequiresError") {
    const std::size_t verb = told.find(" requires ");
    if (verb != std::string::npos) {
      return told.substr(0, verb) + " has a meaning only together with " + told.substr(verb + 10);
    }
  }
  if (kind == "ExcludesError") {
    const std::size_t verb = told.find(" excludes ");
    if (verb != std::string::npos) {
      return told.substr(0, verb) + " and " + told.substr(verb + 10) + " cannot be given together";
    }
  }
  if (kind == "ConversionError") {
    // "Could not convert: --json = 3"
    constexpr std::string_view lead = "Could not convert: ";
    const std::size_t equals = told.find(" = ");
    if (told.starts_with(lead) && equals != std::string::npos) {
      return told.substr(lead.size(), equals - lead.size()) + ": '" + told.substr(equals + 3) +
             "' is not a value for it";
    }
  }
  return told;
}

}  // namespace

std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const CLI::App& command = chosen.empty() ? app : *chosen.front();
  const std::string words = in_words(app, command, error);
  const bool is_of_all =
      app.get_option_no_throw(words.substr(0, words.find_first_of(": "))) != nullptr;
  return words + "\nSee '" + app.get_name() +
         (chosen.empty() || is_of_all ? "" : " " + command.get_name()) + " --help'.";
}

}  // namespace keepout::app
