// SPDX-License-Identifier: BSD-3-Clause
#include "options.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <utility>

#include "bindings.h"
#include "keepout/registry.h"

namespace keepout::python {
namespace {

/// Returns the options of a class as a list of keepout.Option.
template <class Settings>
py::list rows_of(const Settings& settings) {
  const py::object type = py::module_::import("keepout._results").attr("Option");
  py::list rows;
  for_each_option(settings, [&](const auto& option, const auto& of) {
    const bool can_change = &of == static_cast<const void*>(&settings.options);
    const bool is_of_command = std::same_as<Settings, MotionConstraintSettings> &&
                               &of != static_cast<const void*>(&settings.capacity);
    rows.append(type(option.name, type_of(option), option.get(of), option.unit, option.expected(),
                     py::tuple(py::cast(std::vector(option.names.begin(), option.names.end()))),
                     option.meaning, can_change, is_of_command ? option.flag() : ""));
  });
  return rows;
}

template <class Value>
bool load(py::handle given, bool convert, OptionValue& value) {
  py::detail::make_caster<Value> caster;
  const bool is_loaded = caster.load(given, convert);
  if (is_loaded) value = py::detail::cast_op<Value>(caster);
  PyErr_Clear();
  return is_loaded;
}

}  // namespace

OptionValue value_from(const OptionText& option, py::handle given) {
  OptionValue value;
  const bool is_loaded = option.kind == OptionKind::number ? load<double>(given, true, value)
                         : option.kind == OptionKind::whole_number
                             ? load<std::int64_t>(given, true, value)
                         : option.kind == OptionKind::flag ? load<bool>(given, false, value)
                                                           : load<std::string>(given, false, value);
  if (is_loaded) return option.accepted(std::move(value));
  const bool is_short =
      PyLong_Check(given.ptr()) || PyFloat_Check(given.ptr()) || PyUnicode_Check(given.ptr());
  option.refuse(is_short ? py::repr(given).cast<std::string>() : Py_TYPE(given.ptr())->tp_name);
}

std::string type_of(const OptionText& option) {
  switch (option.kind) {
    case OptionKind::number:
      return "float";
    case OptionKind::whole_number:
      return "int";
    case OptionKind::flag:
      return "bool";
    case OptionKind::part:
      return "str";
    case OptionKind::choice:
      break;
  }
  std::string list;
  for (const std::string_view name : option.names) {
    list += (list.empty() ? "'" : ", '") + std::string(name) + "'";
  }
  return "Literal[" + list + "]";
}

std::string described(const OptionText& option) {
  const bool is_choice = option.kind == OptionKind::choice;
  return std::string(option.name) + ": " + std::string(option.meaning) +
         (option.unit.empty() ? "" : " [" + std::string(option.unit) + "]") +
         (is_choice ? " " + option.expected() + "." : "");
}

py::kwargs with_new_names(const py::kwargs& given) {
  constexpr const char* former = "max_looks";
  constexpr const char* name = "max_work_units";
  if (!given.contains(former)) return given;
  if (PyErr_WarnEx(PyExc_DeprecationWarning, "max_looks is now max_work_units", 1) != 0) {
    throw py::error_already_set();
  }
  py::kwargs renamed = py::reinterpret_steal<py::kwargs>(PyDict_Copy(given.ptr()));
  renamed[name] = renamed.attr("pop")(former);
  return renamed;
}

void require_known(std::string_view function, const py::kwargs& given,
                   const std::vector<std::string_view>& known) {
  for (const auto& [key, value] : given) {
    const auto name = py::str(key).cast<std::string>();
    if (std::ranges::find(known, name) != known.end()) continue;
    std::string list;
    for (const std::string_view one : known) list += (list.empty() ? "" : ", ") + std::string(one);
    const auto meant = nearest_name(name, known);
    throw py::type_error(std::string(function) + " has no argument '" + name + "'" +
                         (meant ? "; did you mean '" + std::string(*meant) + "'?" : ";") +
                         " known: " + list);
  }
}

void bind_options(py::module_& module) {
  module.def(
      "options",
      [] {
        py::dict options;
        options["MotionConstraint"] = rows_of(MotionConstraintSettings());
        options["InstrumentGuard"] = rows_of(InstrumentConstraintSettings());
        return options;
      },
      "Returns the options that the constructors take as keywords: a dict of lists of Option,\n"
      "by class.");
}

}  // namespace keepout::python
