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

// Input: arrays, and objects that numpy converts to arrays, checked.

/// Row-major, C-contiguous.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline constexpr py::ssize_t any = -1;

/// `allowed`: an argument may leave out its first axis; the one item then serves all.
enum class OneForAll { refused, allowed };

/// The array that an argument must be: its name, the extent of each axis, and the shape as text.
struct Expected {
  std::string_view name;
  std::initializer_list<py::ssize_t> shape;  // `any`: the caller decides
  std::string_view text;                     // "(n, 3)"
  OneForAll one_for_all = OneForAll::refused;
};

/// Returns the shape as text, such as "(4, 3)".
std::string shape_text(const py::array& array);
/// Returns the type as text, such as "float64".
std::string dtype_text(const py::array& array);
/// Returns the type of an object for messages, such as "str".
std::string type_name(py::handle object);

/// Throws Error with the argument, the expected value and the given one.
[[noreturn]] void refuse(std::string_view name, const std::string& expected,
                         const std::string& got);

/// Returns an array of numbers of the expected shape; copies only if the argument is not one.
/// Throws Error if numpy cannot convert it, or for another shape.
py::array numbers(py::handle argument, const Expected& expected);

/// Like numbers(), but converts to the type of Array if necessary. Throws Error if it cannot: `fit`
/// describes the numbers that it could convert. Throws MemoryError unchanged.
template <class Array>
Array converted(const py::array& array, std::string_view name, const char* fit) {
  try {
    return Array(array);
  } catch (py::error_already_set& error) {
    if (error.matches(PyExc_MemoryError) || !error.matches(PyExc_Exception)) throw;
    refuse(name, fit, "dtype " + dtype_text(array));
  }
}

/// Like numbers(), in double precision.
Doubles doubles(py::handle argument, const Expected& expected);

/// Issues a UserWarning. Throws the Python exception if warnings are errors.
void warn(const std::string& text);

/// Reads three numbers. Fast for an array, a list or a tuple of floats.
Vec3 point(py::handle argument, std::string_view name);

/// Returns a point of a link, from a pair of the link's number and a place (3,) in its frame. The
/// receiver checks that there is such a link.
LinkPoint link_point(py::handle given, const std::string& name);

/// Returns the points of an array, (n, 3) or, if `expected` allows it, one (3,).
std::vector<Vec3> points(py::handle argument, const Expected& expected);

/// Returns a matrix (3, 3). The receiver checks that it is a rotation matrix.
Mat3 rotation(const py::object& matrix);

/// Returns the pose of a homogeneous matrix, (4, 4), or the identity for None. The receiver checks
/// its rotation.
Pose pose_of(const py::object& matrix, std::string_view name);

/// Returns row i of an array of points. Precondition: the array has three columns.
inline Vec3 row(const double* points, std::size_t i) noexcept {
  return {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
}

// Output: copies, and views of memory that the module owns.

/// Writes the sixteen numbers of a homogeneous matrix, row by row.
void write(double* to, const Pose& pose);

/// Returns a homogeneous matrix, (4, 4).
py::array_t<double> matrix_of(const Pose& pose);

/// Returns a read-only array over memory of `owner`, without a copy. Each view keeps the owner
/// alive.
template <class T>
py::array view(const T* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               py::handle owner) {
  py::array array(py::dtype::of<T>(), std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// Like view(), but of a list of numbers.
template <class T>
py::array view(const std::vector<T>& values, py::handle owner) {
  return view(values.data(), {static_cast<py::ssize_t>(values.size())}, {sizeof(T)}, owner);
}

/// Like view(), but of `width` numbers of each item of a list: (n, width), or (n,) if width is 1.
/// `first_of` returns the address of the first number of an item.
template <class Item, class FirstOf>
py::array view(std::span<const Item> items, py::ssize_t width, const FirstOf& first_of,
               py::handle owner) {
  static const Item none{};  // an empty list needs an address as well
  const auto* const first = first_of(items.empty() ? none : items.front());
  const auto size = static_cast<py::ssize_t>(items.size());
  if (width == 1) return view(first, {size}, {sizeof(Item)}, owner);
  return view(first, {size, width}, {sizeof(Item), sizeof(*first)}, owner);
}

/// Adds such a view of a list as a property of a Python class.
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
