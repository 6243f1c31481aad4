// SPDX-License-Identifier: BSD-3-Clause
//
// To be included before numpy.h of pybind11, which uses its own conversion of int.
#pragma once

#include <pybind11/pybind11.h>

#include <limits>
#include <string_view>
#include <type_traits>

namespace keepout::python {

/// Returns false for booleans, and for arrays of booleans or text: float() takes these, too.
inline bool may_be_number(pybind11::handle given) {
  if (PyFloat_CheckExact(given.ptr()) || PyLong_CheckExact(given.ptr())) return true;
  if (PyBool_Check(given.ptr())) return false;
  const pybind11::object dtype = getattr(given, "dtype", pybind11::none());
  const pybind11::object kind = getattr(dtype, "kind", pybind11::none());
  if (!pybind11::isinstance<pybind11::str>(kind)) return true;
  constexpr std::string_view numeric = "fiu";
  return numeric.find(kind.cast<std::string_view>()) != std::string_view::npos;
}

/// Converts a number as pybind11 does, but rejects what may_be_number() rejects.
template <class Number>
struct NumberCaster {
  // A type with the same values, which this caster does not convert.
  using Wide = std::conditional_t<
      std::is_floating_point_v<Number>, long double,
      std::conditional_t<std::is_signed_v<Number>, long long, unsigned long long>>;
  using WideCaster = pybind11::detail::type_caster<Wide>;

  PYBIND11_TYPE_CASTER(Number, WideCaster::name);

  bool load(pybind11::handle given, bool convert) {
    WideCaster wide;
    if (!given || !may_be_number(given) || !wide.load(given, convert)) return false;
    value = static_cast<Number>(static_cast<Wide>(wide));
    return std::is_floating_point_v<Number> || static_cast<Wide>(value) == static_cast<Wide>(wide);
  }
  static pybind11::handle cast(Number number, pybind11::return_value_policy policy,
                               pybind11::handle parent) {
    return WideCaster::cast(number, policy, parent);
  }
};

}  // namespace keepout::python

namespace pybind11::detail {
template <>
struct type_caster<double> : keepout::python::NumberCaster<double> {};
template <>
struct type_caster<int> : keepout::python::NumberCaster<int> {};
template <>
struct type_caster<long> : keepout::python::NumberCaster<long> {};
template <>
struct type_caster<unsigned long> : keepout::python::NumberCaster<unsigned long> {};
}  // namespace pybind11::detail
