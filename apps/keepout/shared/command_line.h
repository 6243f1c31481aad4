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

namespace keepout::app {

// What the options of a command may be told.

/// A name, with a hint at the one that was meant, and a list of all.
CLI::Validator one_of(std::vector<std::string> names);

/// The same, for transform(): names of the values of an enumeration.
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

/// The same of an enumeration whose values from 0 on have these names.
template <class Enum>
CLI::Validator one_of(std::span<const std::string_view> names) {
  std::vector<std::pair<std::string, Enum>> values;
  for (const std::string_view name : names) {
    values.emplace_back(name, static_cast<Enum>(values.size()));
  }
  return one_of(values);
}

/// Accepts the names of the parts that can be had. For a part whose module is absent, the message
/// says what it needs. `backends` returns the registry of these parts.
template <class Backends>
CLI::Validator one_of_parts(std::vector<std::string> names, Backends backends) {
  const CLI::Validator known = one_of(std::move(names));
  const auto check = [known, backends](std::string& text) {
    const std::string problem = known(text);
    if (problem.empty()) return problem;
    for (const PeerPart& part : backends().absent()) {
      if (part.name == text) return "'" + text + "' needs " + std::string(part.needs);
    }
    return problem;
  };
  return {check, known.get_description()};
}

/// Above it, whole numbers are not read back as they were written.
inline constexpr std::uint64_t largest_seed = (std::uint64_t{1} << 63) - 1;

enum class Zero { allowed, refused };

/// A number from `low` to `high`, which `expected` tells in words; CLI11's own checks let 'nan'
/// pass and tell their range in 300 digits. `type`: what the help calls it.
CLI::Validator number_within(double low, double high, std::string expected, std::string type);

/// A length in millimeters. The limit keeps squares of lengths, and sums of them, far from the end
/// of a double's range.
CLI::Validator length(Zero zero);

/// A whole number in decimal digits, or with an exponent, such as 20000, 2e4 or 1.5e3. For
/// transform(), which hands on its digits: CLI11 alone would take '-1' for 2^64 - 1, too many
/// digits for the largest number, and '010' for 8.
CLI::Validator whole_number(std::uint64_t low, std::uint64_t high);

/// The most that a count of steps may be.
inline constexpr std::uint64_t most_steps = 1'000'000'000'000;

/// Any text but an empty one.
CLI::Validator not_empty();

/// A command of ./run that is no command of this program.
inline constexpr const char* run_command = "experiments";

// Options of one kind; the value as it is stands in the help.

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
/// Adds an option of a table; `options` must live as long as the command line is parsed.
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
          ->type_name(option.unit == "length" ? "MM"
                      : option.names.empty()  ? "NUMBER"
                                              : "")
          ->default_str(keepout::text_of(option.get(options)));
  if (!option.names.empty()) added->check(one_of({option.names.begin(), option.names.end()}));
  return added;
}

/// The same for the option of that name.
template <class Options>
CLI::Option* add_option_of(CLI::App& command, std::string_view name, Options& options) {
  return add_option_of(command, option_named(table_of(options), name), options);
}

CLI::Option* add_name(CLI::App& command, const std::string& name, std::string& value,
                      std::vector<std::string> names, const std::string& description);

// What several commands take.

/// Adds an option that chooses an index, a solver or a narrow phase by name: see one_of_parts.
template <class Backends>
CLI::Option* add_part(CLI::App& command, const std::string& name, std::string& value,
                      std::vector<std::string> names, Backends backends,
                      const std::string& description) {
  return command.add_option(name, value, description)
      ->check(one_of_parts(std::move(names), backends))
      ->capture_default_str();
}

/// The mesh: a file or a fixture.
void add_mesh(CLI::App& command, std::filesystem::path& mesh);

/// Adds the options of load_mesh() to a command that places something in the frame of the mesh.
void add_load_options(CLI::App& command, LoadOptions& load);

/// Of every command that builds a motion constraint, but for the rule, of which one may take
/// several.
void add_constraint_options(CLI::App& command, MotionConstraintSettings& settings);
void add_activation(CLI::App& command, std::string& activation);

/// Of every command that guards one tool, and judges it by nothing but the guard: a convex tool in
/// place of the ball. Precondition: add_constraint_options.
void add_convex_tool(CLI::App& command, MotionConstraintSettings& settings);

/// Adds the guides of a tip, and of links if the command has the option --robot already, as texts.
/// Each is checked to be one.
CLI::Option* add_guides(CLI::App& command, std::vector<std::string>& guides);

/// The tool that guides are for.
enum class Guided : std::uint8_t { tip, instrument };

/// Returns the guides of texts that add_guides has taken. Throws CLI::ValidationError if one is not
/// of that tool.
std::vector<Guide> guides_of(std::span<const std::string> texts, Guided guided);

/// Says that there is no command of that name, with a hint at what was meant and at the help.
std::string unknown_command(const CLI::App& app, const std::string& word);

/// Returns the names of a program's commands.
std::vector<std::string> command_names(const CLI::App& app);

/// Returns the names of a command's options, with their dashes.
std::vector<std::string> option_names(const CLI::App& command);

/// Throws CLI::ValidationError if a list has an empty item, as in '1,,2': CLI11 leaves it out.
void refuse_empty_items(const CLI::App& command, std::span<const std::string> words);

/// What is wrong with a command line, in words that name the option and its value, with a hint at
/// what was meant and at the help. `error`: what app.parse() threw, and no call for help.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace keepout::app
