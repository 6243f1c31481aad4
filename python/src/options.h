// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <string_view>
#include <vector>

#include "keepout/factory/for_each_option.h"

namespace keepout::python {

namespace py = pybind11;

/// Returns the value that Python gives for an option. Throws Error if the option cannot have it.
OptionValue value_from(const OptionText& option, py::handle given);

/// Returns "float", "int", "bool", "str", or the names of a choice as a Literal.
std::string type_of(const OptionText& option);

/// Returns the line on an option for a docstring.
std::string described(const OptionText& option);

/// Returns the keywords; renames those that version 0.3 renamed, with a warning.
py::kwargs with_new_names(const py::kwargs& given);

/// Throws TypeError for the first of the `given` keywords that is not `known`, and suggests a name.
void require_known(std::string_view function, const py::kwargs& given,
                   const std::vector<std::string_view>& known);

/// Sets the options of a table that are given and not None. Throws Error for an invalid value.
template <class Table, class Options>
void take_given(const Table& table, const py::kwargs& given, Options& options) {
  for (const auto& option : table) {
    const py::str name{std::string(option.name)};
    if (!given.contains(name) || given[name].is_none()) continue;
    option.set(options, value_from(option, given[name]));
  }
}

/// Returns ", radius: float = 5.0" and so on for all options of the settings.
template <class Settings>
std::string keywords_of(const Settings& settings) {
  std::string text;
  for_each_option(settings, [&](const auto& option, const auto& of) {
    text += ", " + std::string(option.name) + ": " + type_of(option) + " = " +
            py::repr(py::cast(option.get(of))).template cast<std::string>();
  });
  return text;
}

/// Returns the settings of a constraint from the keywords of its constructor. `others`: the
/// arguments that are not in a table. Throws TypeError for an unknown keyword, Error for an invalid
/// value.
template <class Settings>
Settings settings_from(std::string_view type, const py::kwargs& keywords,
                       std::vector<std::string_view> others) {
  const py::kwargs given = with_new_names(keywords);
  Settings settings;
  for_each_option(settings,
                  [&](const auto& option, const auto&) { others.push_back(option.name); });
  require_known(type, given, others);
  take_given(table_of(settings), given, settings);
  take_given(table_of(settings.options), given, settings.options);
  take_given(table_of(settings.capacity), given, settings.capacity);
  return settings;
}

}  // namespace keepout::python
