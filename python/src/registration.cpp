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

/// Warns, as 'keepout register' does, if the residuals speak of a mistake or contradict the FLE.
void warn_of_doubt(const RigidFit& fit, std::optional<double> fle) {
  const std::string doubt = fit.doubt.empty() && fle ? fit.doubt_of(*fle) : fit.doubt;
  if (!doubt.empty()) warn("do not trust the registration: " + doubt);
}

double margin(const RigidFit& fit, const py::object& targets, double confidence,
              std::optional<double> fle) {
  const Expected expected{"targets", {any, 3}, "(n, 3) or (3,)", OneForAll::allowed};
  const double margin = registration_margin(fit, points(targets, expected), confidence, fle);
  warn_of_doubt(fit, fle);
  return margin;
}

py::array_t<double> covariance(const RigidFit& fit, const py::object& target,
                               std::optional<double> fle) {
  const TargetError error = target_error(fit, point(target, "target"), fle);
  warn_of_doubt(fit, fle);
  return array_of(error.covariance);
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

targets: (3,) or (n, 3), in the frame of the mesh. fle: root mean square localization error of a
pair [length]; None: estimated from the residuals, which gives a larger margin for few pairs.

Warns if the residuals contradict fle (RigidFit.doubt_of), or if they suggest a mistake
(RigidFit.doubt). The length does not cover motion after the registration, or errors that all pairs
share.)";

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
      .def_readonly(
          "doubt", &RigidFit::doubt,
          "The mistake that the residuals suggest: a unit, an order or a reflection; else ''.")
      .def(
          "doubt_of", &RigidFit::doubt_of, py::arg("fle"),
          "Returns why a localization error of a pair contradicts the residuals, or ''. It does if "
          "fewer than\none in a thousand registrations with that error have so large an FRE. fle: "
          "root mean square, above 0\n[length].")
      .def("__repr__", [](const RigidFit& self) {
        return py::str("<keepout.RigidFit of {} pairs, fre={:.4g}>")
            .format(self.residuals.size(), self.fre);
      });
  module.def("fit_rigid", &fit, py::arg("measured"), py::arg("model"),
             py::arg("weights") = py::none(), fit_doc);
  module.def(
      "target_error", &covariance, py::arg("fit"), py::arg("target"), py::arg("fle") = py::none(),
      "(3, 3) float64: covariance of the error of a registration at a target (3,), in the mesh's\n"
      "frame [length^2]. The square root of its trace is the target registration error, TRE, root\n"
      "mean square; the root of its largest eigenvalue is the deviation in the worst\n"
      "direction. fle: as in registration_margin.");
  module.def("registration_margin", &margin, py::arg("fit"), py::arg("targets"),
             py::arg("confidence") = 0.99, py::arg("fle") = py::none(), margin_doc);
}

}  // namespace keepout::python
