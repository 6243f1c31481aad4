// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "keepout/error.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/registry.h"
#include "keepout/step/guide.h"
#include "shared/names.h"

namespace keepout::app {

// Options of commands, and validators of their values.

/// Accepts one of these names. The message of an error suggests a similar name and lists all names.
CLI::Validator one_of(std::vector<std::string> names);

/// Accepts the names of the values of an enumeration; for transform().
template <class Enum>
CLI::Validator one_of(const std::vector<std::pair<std::string, Enum>>& values) {
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  const CLI::Validator check = one_of(names);
  const auto replace = [values, check](std::string& text) {
    std::string problem = check(text);
    for (const auto& [name, value] : values) {
      if (problem.empty() && text == name) {
        text = std::to_string(static_cast<std::underlying_type_t<Enum>>(value));
        break;
      }
    }
    return problem;
  };
  return {replace, check.get_description()};
}

/// Accepts the names of the values of an enumeration, which are numbered from 0.
template <class Enum>
CLI::Validator one_of(std::span<const std::string_view> names) {
  std::vector<std::pair<std::string, Enum>> values;
  for (const std::string_view name : names) {
    values.emplace_back(name, static_cast<Enum>(values.size()));
  }
  return one_of(values);
}

/// Accepts the names of the available parts. For a part whose module is absent, the message says
/// what it needs. `backends` returns the registry of these parts.
template <class Backends>
CLI::Validator one_of_parts(std::vector<std::string> at_start, Backends backends) {
  const CLI::Validator known = one_of(std::move(at_start));
  const auto check = [known, backends](std::string& text) {
    const std::string problem = known(text);
    if (problem.empty()) return problem;
    const auto all = backends();  // with the parts of plugins
    for (const PeerPart& part : all.absent()) {
      if (part.name == text) return "'" + text + "' needs " + std::string(part.needs);
    }
    return one_of(names(all))(text);
  };
  return {check, known.get_description()};
}

/// The largest whole number that is read back unchanged from a record.
inline constexpr std::uint64_t largest_seed = (std::uint64_t{1} << 63) - 1;

enum class Zero { allowed, refused };

/// Accepts a number from `low` to `high`. `expected` describes the range in words, and `type` is
/// its name in the help. CLI11's own check accepts 'nan' and prints the range with 300 digits.
CLI::Validator number_within(double low, double high, std::string expected, std::string type);

/// Accepts a length in millimeters. Its limit keeps sums of squared lengths far from overflow.
CLI::Validator length(Zero zero);

/// Accepts a whole number in decimal digits, or with an exponent, such as 20000, 2e4 or 1.5e3. For
/// transform(), which passes the digits on. CLI11 alone accepts '-1' as 2^64 - 1, a number with too
/// many digits as the largest number, and '010' as 8.
CLI::Validator whole_number(std::uint64_t low, std::uint64_t high);

/// The largest count of steps.
inline constexpr std::uint64_t most_steps = 1'000'000'000'000;

/// Accepts any text that is not empty.
CLI::Validator not_empty();

/// A command of ./run that is not a command of this program.
inline constexpr const char* run_command = "experiments";

// Options of one kind; the help shows the current value.

CLI::Option* add_length(CLI::App& command, const std::string& name, double& value, Zero zero,
                        const std::string& description);
template <class Number>
CLI::Option* add_number(CLI::App& command, const std::string& name, Number& value,
                        std::uint64_t low, std::uint64_t high, const std::string& description) {
  return command.add_option(name, value, description)
      ->type_name("NUMBER")
      ->transform(whole_number(low, high))
      ->capture_default_str();
}
/// Adds an option of a table. `options` must outlive the parsing of the command line.
template <class Options>
CLI::Option* add_option_of(CLI::App& command, const Option<Options>& option, Options& options) {
  const auto take = [&](const std::string& text) {
    try {
      option.set(options, option.parsed(text));
    } catch (const Error&) {
      throw CLI::ValidationError("--" + option.flag(),
                                 "expected " + option.expected() + ", not '" + text + "'");
    }
  };
  CLI::Option* added =
      command
          .add_option_function<std::string>("--" + option.flag(), take, std::string(option.meaning))
          ->type_name(option.unit == "length"           ? "MM"
                      : option.kind == OptionKind::flag ? "true|false"
                      : option.names.empty()            ? "NUMBER"
                                                        : "")
          ->default_str(keepout::text_of(option.get(options)));
  if (!option.names.empty()) added->check(one_of({option.names.begin(), option.names.end()}));
  return added;
}

/// Adds the option of this name.
template <class Options>
CLI::Option* add_option_of(CLI::App& command, std::string_view name, Options& options) {
  return add_option_of(command, option_named(table_of(options), name), options);
}

CLI::Option* add_name(CLI::App& command, const std::string& name, std::string& value,
                      std::vector<std::string> names, const std::string& description);

// Options that several commands have.

/// Adds the option --plugin, which loads shared objects with indices and solvers of the user. Add
/// it before the options that choose parts by name, so that they know the names in the plugins.
CLI::Option* add_plugins(CLI::App& command);

/// Adds an option that chooses an index, a solver or a narrow phase by name: see one_of_parts.
template <class Backends>
CLI::Option* add_part(CLI::App& command, const std::string& name, std::string& value,
                      std::vector<std::string> names, Backends backends,
                      const std::string& description) {
  return command.add_option(name, value, description)
      ->check(one_of_parts(std::move(names), backends))
      ->capture_default_str();
}

/// Adds the mesh: a file or the name of a sample mesh.
void add_mesh(CLI::App& command, std::filesystem::path& mesh);

/// Adds the options of load_mesh() to a command that places something in the frame of the mesh.
void add_load_options(CLI::App& command, LoadOptions& load);

/// Adds the options of a motion constraint except the rule: some commands take several rules.
void add_constraint_options(CLI::App& command, MotionConstraintSettings& settings);
void add_activation(CLI::App& command, std::string& activation);

/// Adds a convex tool that replaces the ball, for commands that guard one tool and use only the
/// guard as judge. Precondition: add_constraint_options.
void add_convex_tool(CLI::App& command, MotionConstraintSettings& settings);

/// Adds --robot, which names one of `names` or a URDF file, and --bodies, the bodies of the latter.
/// Returns the first. `help`: what the command does with the robot.
CLI::Option* add_robot(CLI::App& command, std::string& robot, std::filesystem::path& bodies,
                       std::vector<std::string> names, const std::string& help);

/// Adds the guides of a tip as texts, and of links if the command already has the option --robot.
/// Checks that each text is a guide.
CLI::Option* add_guides(CLI::App& command, std::vector<std::string>& guides);

/// The kind of tool that guides constrain.
enum class Guided : std::uint8_t { tip, instrument };

/// Returns the guides of texts that add_guides has taken. Throws CLI::ValidationError if one is not
/// for this kind of tool.
std::vector<Guide> guides_of(std::span<const std::string> texts, Guided guided);

/// Returns a message that there is no command of this name, with a similar name and a hint at the
/// help.
std::string unknown_command(const CLI::App& app, const std::string& word);

/// Returns the names of a program's commands.
std::vector<std::string> command_names(const CLI::App& app);

/// Returns the names of a command's options, with their dashes.
std::vector<std::string> option_names(const CLI::App& command);

/// Throws CLI::ValidationError if a list has an empty item, as in '1,,2': CLI11 leaves it out.
void refuse_empty_items(const CLI::App& command, std::span<const std::string> words);

/// Returns a message on a wrong command line. It names the option and its value, suggests a similar
/// name and points to the help. `error`: what app.parse() threw; not a request for help.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace keepout::app
