// SPDX-License-Identifier: BSD-3-Clause
#include "shared/completion.h"

#include <algorithm>
#include <array>
#include <ostream>

#include "shared/command_line.h"
#include "shared/named_mesh.h"

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

/// Returns the argument without an option's name that follows `count` others; or null.
const CLI::Option* argument_after(const CLI::App& command, std::size_t count) {
  const std::vector<const CLI::Option*> arguments =
      command.get_options([](const CLI::Option* option) { return option->get_positional(); });
  if (arguments.empty()) return nullptr;
  const bool is_list = arguments.back()->get_items_expected_max() > 1;
  if (count >= arguments.size() && !is_list) return nullptr;
  return arguments[std::min(count, arguments.size() - 1)];
}

bool is_mesh(const CLI::Option& option) {
  constexpr std::array names{"MESH", "IN", "--mesh"};
  return std::ranges::any_of(names, [&](const char* name) { return option.check_name(name); });
}

}  // namespace

void print_completions(const CLI::App& app, std::span<const std::string> words, std::ostream& out) {
  if (words.empty()) return;
  const CLI::App* command = &app;
  const CLI::Option* open = nullptr;  // waits for its value
  std::size_t arguments = 0;          // of the command, without an option's name
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
    } else {
      ++arguments;
    }
  }
  const std::string start = words.back() == "=" ? "" : words.back();
  const bool is_option = open == nullptr && start.starts_with("-");
  if (open == nullptr && !is_option) open = argument_after(*command, arguments);
  if (open != nullptr && command->get_name() == "help") {  // it takes the name of a command
    command = &app;
    open = nullptr;
  }
  const bool is_of_mesh = open != nullptr && is_mesh(*open);
  std::vector<std::string> candidates = is_option         ? option_names(*command)
                                        : is_of_mesh      ? fixture_names()
                                        : open != nullptr ? values_of(*open)
                                                          : command_names(*command);
  std::erase_if(candidates, [&](const std::string& name) { return !name.starts_with(start); });
  for (const std::string& candidate : candidates) out << candidate << '\n';
  if (is_of_mesh && !candidates.empty()) out << '\n';
}

}  // namespace keepout::app
