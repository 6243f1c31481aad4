// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <concepts>
#include <string>
#include <string_view>

#include "arrays.h"

namespace keepout::python {

/// An argument that a function takes by taken(), so that an error is in our words. The signature
/// in its docstring names the type T.
template <class T>
struct Given {
  py::object object = {};
};

/// Returns what a message calls a value of type T.
template <class T>
std::string wanted_text() {
  if constexpr (std::same_as<T, std::string>) {
    return "a str";
  } else if constexpr (std::integral<T>) {
    return "a whole number";
  } else if constexpr (std::floating_point<T>) {
    return "a number";
  } else {
    return "a keepout." + py::type::of<T>().attr("__name__").template cast<std::string>();
  }
}

/// Returns the value of an argument. Throws Error, which names the argument, for another type.
template <class T>
T taken(const Given<T>& given, std::string_view name) {
  py::detail::make_caster<T> caster;
  if (caster.load(given.object, true) && !given.object.is_none()) {
    return py::detail::cast_op<T&>(caster);
  }
  PyErr_Clear();
  refuse(name, wanted_text<T>(), type_name(given.object));
}

}  // namespace keepout::python

namespace pybind11::detail {

template <class T>
struct type_caster<keepout::python::Given<T>> {
  PYBIND11_TYPE_CASTER(keepout::python::Given<T>, make_caster<T>::name);
  bool load(handle source, bool) {
    value.object = reinterpret_borrow<object>(source);
    return true;
  }
};

}  // namespace pybind11::detail
