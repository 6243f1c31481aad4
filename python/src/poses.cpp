// SPDX-License-Identifier: BSD-3-Clause
#include "poses.h"

#include <Eigen/Core>

#include "arrays.h"

namespace keepout::python {
namespace {

using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

}  // namespace

Pose pose_of(const py::object& matrix, std::string_view name) {
  if (matrix.is_none()) return {};
  const Doubles numbers = doubles(matrix, {name, {4, 4}, "(4, 4)"});
  const Eigen::Map<const Matrix4> m(numbers.data());
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    refuse(name, "a homogeneous matrix, whose last row is 0, 0, 0, 1", "another last row");
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
