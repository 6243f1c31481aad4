// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/convex_tool.h"

#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "keepout/factory/convex_tool_text.h"

namespace keepout::python {
namespace {

ConvexTool hull(const py::object& given, double radius) {
  const Doubles points = doubles(given, {"points", {any, 3}, "(n, 3)"});
  std::vector<Vec3> corners;
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    corners.push_back(row(points.data(), static_cast<std::size_t>(i)));
  }
  return ConvexTool::hull(corners, radius);
}

ConvexTool rotated(const ConvexTool& tool, const py::object& rotation) {
  const Doubles numbers = doubles(rotation, {"rotation", {3, 3}, "(3, 3)"});
  using RowByRow = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return tool.rotated(Eigen::Map<const RowByRow>(numbers.data()));
}

py::array points(const py::object& self) {
  const auto first_of = [](const Vec3& p) { return p.data(); };
  return view(self.cast<const ConvexTool&>().points(), 3, first_of, self);
}

constexpr const char* tool_doc =
    R"(A rigid tool that is more than a ball, for MotionConstraint(mesh, tool=...): the convex hull of up
to 64 points, its core, grown by a radius. Its origin is the tip, its axes are the mesh's; it moves
with the tip and does not turn. Made by sphere, capsule, box, hull or of_text. [length])";

constexpr const char* text_doc =
    R"(A tool from a text: 'sphere:R', 'capsule:X,Y,Z:X,Y,Z:R', 'box:X,Y,Z:X,Y,Z', 'hull:X,Y,Z:...[:R]',
'hull:FILE', of whose mesh the vertices count, or 'blade:LENGTH:WIDTH:THICKNESS', which rises LENGTH
along z from the tip, WIDTH across in x and THICKNESS in y.)";

}  // namespace

void bind_convex_tool(py::module_& module) {
  py::class_<ConvexTool>(module, "ConvexTool", tool_doc)
      .def_static("sphere", &ConvexTool::sphere, py::arg("radius"), "A ball around the tip.")
      .def_static(
          "capsule",
          [](const py::object& start, const py::object& end, double radius) {
            return ConvexTool::capsule(point(start, "start"), point(end, "end"), radius);
          },
          py::arg("start"), py::arg("end"), py::arg("radius"),
          "All within `radius` of the segment between two points (3,).")
      .def_static(
          "box",
          [](const py::object& low, const py::object& high) {
            return ConvexTool::box({point(low, "low"), point(high, "high")});
          },
          py::arg("low"), py::arg("high"), "A box along the axes, between two corners (3,).")
      .def_static("hull", &hull, py::arg("points"), py::arg("radius") = 0.0,
                  "All within `radius` of the convex hull of points (n, 3), in any order.")
      .def_static("of_text", &tool_of_text, py::arg("text"), text_doc)
      .def("rotated", &rotated, py::arg("rotation"),
           "The same tool, turned about the tip by a rotation matrix (3, 3).")
      .def_property_readonly("points", &points, "(n, 3) float64: of the core, as given [length].")
      .def_property_readonly("radius", &ConvexTool::radius, "[length]")
      .def("__repr__", [](const ConvexTool& self) {
        return py::str("<keepout.ConvexTool of {} points, radius {:g}>")
            .format(self.points().size(), self.radius());
      });
}

}  // namespace keepout::python
