// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"

#include <Eigen/Core>
#include <algorithm>

#include "keepout/error.h"

namespace keepout::python {
namespace {

using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

bool fits(const py::array& array, const Expected& expected) {
  const auto axes = static_cast<std::size_t>(array.ndim());
  const auto* first = expected.shape.begin();
  if (expected.one_for_all == OneForAll::allowed && axes + 1 == expected.shape.size()) ++first;
  return std::equal(
      first, expected.shape.end(), array.shape(), array.shape() + axes,
      [](py::ssize_t wanted, py::ssize_t got) { return wanted == any || wanted == got; });
}

/// Reads a list or a tuple of three floats. Returns false for any other object, as integers are not
/// converted.
bool read_floats(PyObject* object, Vec3& values) {
  if (!PyTuple_CheckExact(object) && !PyList_CheckExact(object)) return false;
  if (PySequence_Fast_GET_SIZE(object) != 3) return false;
  for (py::ssize_t i = 0; i < 3; ++i) {
    PyObject* const value = PySequence_Fast_GET_ITEM(object, i);
    if (!PyFloat_CheckExact(value)) return false;
    values[i] = PyFloat_AS_DOUBLE(value);
  }
  return true;
}

/// Copies three doubles from an array of any stride. Returns false for any other object.
bool read_array(py::handle argument, Vec3& values) {
  // Rejects subclasses, such as masked arrays.
  if (Py_TYPE(argument.ptr()) != py::detail::npy_api::get().PyArray_Type_ ||
      !py::isinstance<py::array_t<double>>(argument)) {
    return false;
  }
  const auto array = py::reinterpret_borrow<py::array_t<double>>(argument);
  if (array.ndim() != 1 || array.shape(0) != 3) return false;
  for (py::ssize_t i = 0; i < 3; ++i) values[i] = array.at(i);
  return true;
}

}  // namespace

void warn(const std::string& text) {
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

std::string shape_text(const py::array& array) {
  return py::str(array.attr("shape")).cast<std::string>();
}

std::string dtype_text(const py::array& array) {
  return py::str(array.dtype()).cast<std::string>();
}

std::string type_name(py::handle object) {
  constexpr std::string_view module = "keepout._core.", package = "keepout.";
  const std::string_view name = Py_TYPE(object.ptr())->tp_name;
  if (!name.starts_with(module)) return std::string(name);
  return std::string(package) + std::string(name.substr(module.size()));
}

void refuse(std::string_view name, const std::string& expected, const std::string& got) {
  throw Error(std::string(name) + ": expected " + expected + ", got " + got);
}

py::array numbers(py::handle argument, const Expected& expected) {
  const std::string wanted = "numbers of shape " + std::string(expected.text);
  if (argument.is_none()) refuse(expected.name, wanted, "None");
  if (py::hasattr(argument, "mask")) {
    refuse(expected.name, wanted, "a masked array, whose mask would be lost; fill it first");
  }
  py::array array;
  try {
    array = py::module_::import("numpy").attr("asarray")(argument);
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    refuse(expected.name, wanted, type_name(argument) + " of which numpy makes no array");
  }
  // An empty array has no type of its own.
  constexpr std::string_view kinds = "fiu";
  if (kinds.find(array.dtype().kind()) == std::string_view::npos && array.size() > 0) {
    refuse(expected.name, wanted, "an array of dtype " + dtype_text(array));
  }
  if (!fits(array, expected)) {
    refuse(expected.name, wanted, "shape " + shape_text(array));
  }
  return array;
}

Doubles doubles(py::handle argument, const Expected& expected) {
  return converted<Doubles>(numbers(argument, expected), expected.name,
                            "numbers that fit a double");
}

Vec3 point(py::handle argument, std::string_view name) {
  Vec3 values;
  if (read_array(argument, values) || read_floats(argument.ptr(), values)) return values;
  const Doubles three = doubles(argument, {name, {3}, "(3,)"});
  return row(three.data(), 0);
}

LinkPoint link_point(py::handle given, const std::string& name) {
  const auto no_pair = [&] {
    refuse(name, "a pair of a link's number and a point of it, (link, (x, y, z))",
           type_name(given));
  };
  if (!PyTuple_Check(given.ptr()) && !PyList_Check(given.ptr())) no_pair();
  const auto pair = py::reinterpret_borrow<py::sequence>(given);
  if (py::len(pair) != 2) no_pair();
  const py::object link = pair[0];
  if (!PyIndex_Check(link.ptr()) || !may_be_number(link)) {
    refuse(name + "[0]", "the number of a link", type_name(link));
  }
  const py::ssize_t number = PyNumber_AsSsize_t(link.ptr(), nullptr);  // clipped; the receiver
                                                                       // rejects it
  return {static_cast<int>(std::clamp<py::ssize_t>(number, -1, 1000)),
          point(pair[1], name + "[1]")};
}

std::vector<Vec3> points(py::handle argument, const Expected& expected) {
  const Doubles numbers = doubles(argument, expected);
  std::vector<Vec3> points(static_cast<std::size_t>(numbers.size()) / 3);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = row(numbers.data(), i);
  return points;
}

Mat3 rotation(const py::object& matrix) {
  const Doubles numbers = doubles(matrix, {"rotation", {3, 3}, "(3, 3)"});
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
}

Pose pose_of(const py::object& matrix, std::string_view name) {
  if (matrix.is_none()) return {};
  const Doubles numbers = doubles(matrix, {name, {4, 4}, "(4, 4)"});
  const Eigen::Map<const Matrix4> m(numbers.data());
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    refuse(name, "a homogeneous matrix with the last row 0, 0, 0, 1", "another last row");
  }
  return {m.topRightCorner<3, 1>(), m.topLeftCorner<3, 3>()};
}

void write(double* to, const Pose& pose) {
  Eigen::Map<Matrix4> m(to);
  m.setIdentity();
  m.topRightCorner<3, 1>() = pose.position;
  m.topLeftCorner<3, 3>() = pose.rotation;
}

py::array_t<double> matrix_of(const Pose& pose) {
  py::array_t<double> matrix({4, 4});
  write(matrix.mutable_data(), pose);
  return matrix;
}

}  // namespace keepout::python
