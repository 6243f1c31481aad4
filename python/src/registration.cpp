// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <optional>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "keepout/control/rigid_fit.h"
#include "keepout/control/target_error.h"

namespace keepout::python {
namespace {

/// Returns a copy, row by row.
template <class Matrix>
py::array_t<double> array_of(const Matrix& matrix) {
  py::array_t<double> array({matrix.rows(), matrix.cols()});
  for (int i = 0; i < matrix.rows(); ++i) {
    for (int j = 0; j < matrix.cols(); ++j) array.mutable_at(i, j) = matrix(i, j);
  }
  return array;
}

RigidFit fit(const py::object& measured, const py::object& model, const py::object& weights) {
  std::vector<double> each;
  if (!weights.is_none()) {
    const Doubles given = doubles(weights, {"weights", {any}, "(n,)"});
    each.assign(given.data(), given.data() + given.size());
    if (each.empty()) refuse("weights", "one for each pair, or None", "none at all");
  }
  return fit_rigid(points(measured, {"measured", {any, 3}, "(n, 3)"}),
                   points(model, {"model", {any, 3}, "(n, 3)"}), each);
}

double margin(const RigidFit& fit, const py::object& targets, double confidence,
              std::optional<double> fle) {
  const Expected expected{"targets", {any, 3}, "(n, 3) or (3,)", OneForAll::allowed};
  return registration_margin(fit, points(targets, expected), confidence, fle);
}

constexpr const char* fit_doc =
    R"(Fits a rotation and a translation that bring points measured in the robot's frame onto the
same points of the model, in the frame of the mesh. Returns a RigidFit.

measured, model: (n, 3), n >= 3 pairs in the same order, both in the unit of the mesh. For a mesh in
mm, multiply points measured in meters by 1000.
weights: (n,), above 0, ideally proportional to the inverse square of the pair's localization error;
None: all equal.

Raises Error for points that coincide or lie on a line. Large residuals are no error: see
RigidFit.doubt.)";

constexpr const char* margin_doc =
    R"(Returns the length to add to a guard's margin for the error of the registration. With
probability `confidence`, the error is smaller [length]. This holds at the target, or at all
points of the convex hull of several targets, such as the corners of the box in which the tool
works.

targets: (3,) or (n, 3), in the frame of the mesh.
fle: root mean square localization error of a pair [length]; None: estimated from the residuals,
which gives a larger margin if they are few.

The margin does not cover errors that all pairs share, or later motion.)";

}  // namespace

void bind_registration(py::module_& module) {
  py::class_<RigidFit>(module, "RigidFit",
                       "The rotation and translation that bring measured points onto those of a\n"
                       "mesh.")
      .def_property_readonly(
          "mesh_from_robot", [](const RigidFit& self) { return array_of(self.matrix()); },
          "(4, 4) float64: transforms a measured point to the frame of the mesh; also the\n"
          "`base` of a Chain.")
      .def_property_readonly(
          "residuals",
          [](const py::object& self) { return view(self.cast<const RigidFit&>().residuals, self); },
          "(n,) float64: the distance that remains between the points of each pair [length].")
      .def_readonly("fre", &RigidFit::fre,
                    "Fiducial registration error: weighted root mean square of the residuals "
                    "[length].")
      .def_property_readonly("estimated_fle", &RigidFit::estimated_fle,
                             "Localization error of a pair, estimated from the residuals\n"
                             "[length].")
      .def_readonly("scale", &RigidFit::scale,
                    "Ratio of the spread of the model's points to that of the measured points.")
      .def_readonly("doubt", &RigidFit::doubt,
                    "The mistake that the residuals suggest: a unit, an order or a reflection;\n"
                    "'' if none.")
      .def("__repr__", [](const RigidFit& self) {
        return py::str("<keepout.RigidFit of {} pairs, fre={:.4g}>")
            .format(self.residuals.size(), self.fre);
      });
  module.def("fit_rigid", &fit, py::arg("measured"), py::arg("model"),
             py::arg("weights") = py::none(), fit_doc);
  module.def(
      "target_error",
      [](const RigidFit& fit, const py::object& target, std::optional<double> fle) {
        return array_of(target_error(fit, point(target, "target"), fle).covariance);
      },
      py::arg("fit"), py::arg("target"), py::arg("fle") = py::none(),
      "Returns (3, 3) float64: the covariance of the registration error at a target (3,), in\n"
      "the frame of the mesh [length^2]. The square root of its trace is the target\n"
      "registration error (TRE), root mean square. The square root of its largest eigenvalue is\n"
      "the standard deviation in the worst direction. fle: as in registration_margin.");
  module.def("registration_margin", &margin, py::arg("fit"), py::arg("targets"),
             py::arg("confidence") = 0.99, py::arg("fle") = py::none(), margin_doc);
}

}  // namespace keepout::python
