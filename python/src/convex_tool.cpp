// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/convex_tool.h"

#include <cmath>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "keepout/factory/convex_tool_text.h"
#include "keepout/geometry/separation.h"

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

ConvexTool box(const py::object& low, const py::object& high) {
  const Box box{point(low, "low"), point(high, "high")};
  if (!(box.low.array() <= box.high.array()).all()) {
    refuse("low", "numbers that are not above those of high", "one that is");
  }
  return ConvexTool::box(box);
}

ConvexTool rotated(const ConvexTool& tool, const py::object& rotation) {
  const Doubles numbers = doubles(rotation, {"rotation", {3, 3}, "(3, 3)"});
  using RowByRow = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return tool.rotated(Eigen::Map<const RowByRow>(numbers.data()));
}

py::array_t<double> separations(const ConvexTool& tool, const py::object& position,
                                const py::object& triangles) {
  const Vec3 at = point(position, "position");
  const Doubles corners = doubles(triangles, {"triangles", {any, 3, 3}, "(m, 3, 3)"});
  py::array_t<double> distances(corners.shape(0));
  for (std::size_t i = 0; i < static_cast<std::size_t>(corners.shape(0)); ++i) {
    const Triangle triangle{row(corners.data(), 3 * i), row(corners.data(), 3 * i + 1),
                            row(corners.data(), 3 * i + 2)};
    const bool usable = is_in_range(at, triangle);
    distances.mutable_data()[i] = usable ? separation(tool, at, triangle).distance : std::nan("");
  }
  return distances;
}

py::array points(const py::object& self) {
  const auto& tool = self.cast<const ConvexTool&>();
  return view(
      tool.points(), 3, [](const Vec3& p) { return p.data(); }, self);
}

constexpr const char* tool_doc =
    R"(A rigid tool that is more than a ball, for MotionConstraint(mesh, tool=...): the convex hull of up
to 64 points, its core, grown by a radius. Its origin is the tip, its axes are the mesh's; it moves
with the tip and does not turn. Made by sphere, capsule, box, hull or of_text. [length])";

constexpr const char* text_doc =
    R"(A tool from a line of text, as the keepout command takes it after --tool:
'sphere:R', 'capsule:x,y,z:x,y,z:R', 'box:x,y,z:x,y,z', 'blade:LENGTH:WIDTH:THICKNESS',
'hull:x,y,z:...[:R]' or 'hull:FILE'. A blade rises LENGTH along z from the tip, WIDTH across in x
and THICKNESS in y; of a mesh file the vertices count.)";

constexpr const char* separations_doc =
    R"(How far the tool is from each triangle, (m,) float64 [length]: below 0 how deep they are in one
another, NaN for what is not finite. To check a loop by, or to look for what is near.

position: (3,), where the tip is. triangles: (m, 3, 3), their corners: mesh.vertices[mesh.triangles],
or those that an Index finds near.)";

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
      .def_static("box", &box, py::arg("low"), py::arg("high"),
                  "A box along the axes, from the corner `low` to the corner `high`, (3,) each.")
      .def_static("hull", &hull, py::arg("points"), py::arg("radius") = 0.0,
                  "All within `radius` of the convex hull of points (n, 3), in any order.")
      .def_static("of_text", &tool_of_text, py::arg("text"), text_doc)
      .def("rotated", &rotated, py::arg("rotation"),
           "The same tool, turned about the tip by a rotation matrix (3, 3).")
      .def("separations", &separations, py::arg("position"), py::arg("triangles"), separations_doc)
      .def_property_readonly("points", &points, "(n, 3) float64: of the core, as given [length].")
      .def_property_readonly("radius", &ConvexTool::radius, "[length]")
      .def("__repr__", [](const ConvexTool& self) {
        return py::str("<keepout.ConvexTool of {} points, radius {:g}>")
            .format(self.points().size(), self.radius());
      });
}

}  // namespace keepout::python
