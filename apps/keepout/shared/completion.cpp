// SPDX-License-Identifier: BSD-3-Clause
#include "shared/completion.h"

#include <algorithm>
#include <ostream>

#include "shared/command_line.h"

namespace keepout::app {
namespace {

/// Returns the names that an option takes: its help lists them in braces (one_of).
std::vector<std::string> values_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t first = type.find('{');
  const std::size_t last = type.find('}', first);
  if (first == std::string::npos || last == std::string::npos) return {};
  std::vector<std::string> values =
      CLI::detail::split(type.substr(first + 1, last - first - 1), ',');
  for (std::string& value : values) CLI::detail::trim(value);
  return values;
}

/// Returns the names of all commands and the values of all arguments that have no option's name.
std::vector<std::string> words_of(const CLI::App& command) {
  std::vector<std::string> words = command_names(command);
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional()) continue;
    for (std::string& value : values_of(*option)) words.push_back(std::move(value));
  }
  return words;
}

}  // namespace

void print_completions(const CLI::App& app, std::span<const std::string> words, std::ostream& out) {
  if (words.empty()) return;
  const CLI::App* command = &app;
  const CLI::Option* open = nullptr;  // waits for its value
  for (const std::string& word : words.first(words.size() - 1)) {
    if (word == "=") continue;
    if (open != nullptr) {
      open = nullptr;
      continue;
    }
    if (word.starts_with("-")) {
      open = command->get_option_no_throw(word);
      if (open != nullptr && open->get_items_expected_max() == 0) open = nullptr;
    } else if (command == &app) {
      const std::vector<std::string> commands = command_names(app);
      if (std::ranges::find(commands, word) != commands.end()) command = app.get_subcommand(word);
    }
  }
  const std::string start = words.back() == "=" ? "" : words.back();
  const std::vector<std::string> candidates = open != nullptr          ? values_of(*open)
                                              : start.starts_with("-") ? option_names(*command)
                                                                       : words_of(*command);
  for (const std::string& candidate : candidates) {
    if (candidate.starts_with(start)) out << candidate << '\n';
  }
}

}  // namespace keepout::app
