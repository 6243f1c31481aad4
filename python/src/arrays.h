// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "numbers.h"

// Behind it.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/shapes.h"

namespace keepout::python {

namespace py = pybind11;

// What comes in: arrays and all that numpy makes arrays of, checked.

/// Row by row, without gaps.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline constexpr py::ssize_t any = -1;

/// Whether an argument may leave out its first axis: then what there is stands for all.
enum class OneForAll { refused, allowed };

/// What an argument shall look like: its name, an extent for each axis, and how to write that.
struct Expected {
  std::string_view name;
  std::initializer_list<py::ssize_t> shape;  // `any` where the caller decides
  std::string_view text;                     // "(n, 3)"
  OneForAll one_for_all = OneForAll::refused;
};

/// "(4, 3)"
std::string shape_text(const py::array& array);
/// "float64"
std::string dtype_text(const py::array& array);
/// Returns the type of an object, for messages: "str".
std::string type_name(py::handle object);

/// Throws Error, naming the argument, what was expected and what came.
[[noreturn]] void refuse(std::string_view name, const std::string& expected,
                         const std::string& got);

/// Anything that numpy makes an array of, of numbers and of the shape expected. Throws Error
/// otherwise. A copy only where it is not that already.
py::array numbers(py::handle argument, const Expected& expected);

/// The same, as an array of one type: converted only where it is not that already. Throws Error
/// when it cannot be, naming what would `fit`; and MemoryError, as it is.
template <class Array>
Array converted(const py::array& array, std::string_view name, const char* fit) {
  try {
    return Array(array);
  } catch (py::error_already_set& error) {
    if (error.matches(PyExc_MemoryError) || !error.matches(PyExc_Exception)) throw;
    refuse(name, fit, "dtype " + dtype_text(array));
  }
}

/// The same in double precision.
Doubles doubles(py::handle argument, const Expected& expected);

/// Tells the user, as a UserWarning. Throws what Python makes of it where warnings are errors.
void warn(const std::string& text);

/// Three numbers. Fast for an array, a list or a tuple of floats.
Vec3 point(py::handle argument, std::string_view name);

/// Returns a point of a link, from a pair of the link's number and a place (3,) in its frame. The
/// receiver checks that there is such a link.
LinkPoint link_point(py::handle given, const std::string& name);

/// The points of an array, (n, 3) or, if `expected` allows it, one (3,).
std::vector<Vec3> points(py::handle argument, const Expected& expected);

/// A rotation matrix, (3, 3). The receiver checks that it is one.
Mat3 rotation(const py::object& matrix);

/// The pose of a homogeneous matrix, (4, 4); None is the identity. The receiver checks its
/// rotation.
Pose pose_of(const py::object& matrix, std::string_view name);

/// As the index of a row in an array of points. Precondition: the array has three columns.
inline Vec3 row(const double* points, std::size_t i) noexcept {
  return {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
}

// What goes out: copies, and views of what we hold.

/// Writes the sixteen numbers of a homogeneous matrix, row by row.
void write(double* to, const Pose& pose);

/// Returns a homogeneous matrix, (4, 4).
py::array_t<double> matrix_of(const Pose& pose);

/// A read-only array over memory that `owner` keeps: no copy, and the owner lives as long as any
/// view does.
template <class T>
py::array view(const T* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               py::handle owner) {
  py::array array(py::dtype::of<T>(), std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// The same of a list of numbers.
template <class T>
py::array view(const std::vector<T>& values, py::handle owner) {
  return view(values.data(), {static_cast<py::ssize_t>(values.size())}, {sizeof(T)}, owner);
}

/// The same of `width` numbers of each item of a list, (n, width), or (n,) for a single one, which
/// `first_of` an item finds.
template <class Item, class FirstOf>
py::array view(std::span<const Item> items, py::ssize_t width, const FirstOf& first_of,
               py::handle owner) {
  static const Item none{};  // of an empty list no number is read, but an address is
  const auto* const first = first_of(items.empty() ? none : items.front());
  const auto size = static_cast<py::ssize_t>(items.size());
  if (width == 1) return view(first, {size}, {sizeof(Item)}, owner);
  return view(first, {size, width}, {sizeof(Item), sizeof(*first)}, owner);
}

/// Adds such a view of a list that a class of Python has.
template <class Class, class Holder, class Item, class FirstOf>
void add_view(Class& type, const char* name, std::vector<Item> Holder::*items, py::ssize_t width,
              const FirstOf& first_of, const char* doc) {
  type.def_property_readonly(
      name,
      [items, width, first_of](const py::object& self) {
        return view(std::span<const Item>(self.cast<const Holder&>().*items), width, first_of,
                    self);
      },
      doc);
}

}  // namespace keepout::python
