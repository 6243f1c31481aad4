// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/convex_tool.h"

#include "arrays.h"
#include "bindings.h"
#include "keepout/factory/convex_tool_text.h"

namespace keepout::python {
namespace {

ConvexTool hull(const py::object& given, double radius) {
  return ConvexTool::hull(points(given, {"points", {any, 3}, "(n, 3)"}), radius);
}

ConvexTool rotated(const ConvexTool& tool, const py::object& by) {
  return tool.rotated(rotation(by));
}

py::array core_of(const py::object& self) {
  const auto first_of = [](const Vec3& p) { return p.data(); };
  return view(self.cast<const ConvexTool&>().points(), 3, first_of, self);
}

constexpr const char* tool_doc =
    R"(A rigid convex tool, for MotionConstraint(mesh, tool=...): the convex hull of up to 64 points
(the core), grown by a radius. Its origin is the tip, and its axes are those of the mesh. It moves
with the tip and does not turn. Made by sphere, capsule, box, hull or of_text. [length])";

constexpr const char* text_doc =
    R"(Returns a tool from a text: 'sphere:R', 'capsule:X,Y,Z:X,Y,Z:R', 'box:X,Y,Z:X,Y,Z',
'hull:X,Y,Z:...[:R]', 'hull:FILE' (the vertices of a mesh file) or 'blade:LENGTH:WIDTH:THICKNESS'. A
blade extends LENGTH from the tip along z, WIDTH in x and THICKNESS in y.)";

}  // namespace

void bind_convex_tool(py::module_& module) {
  py::class_<ConvexTool>(module, "ConvexTool", tool_doc)
      .def_static("sphere", &ConvexTool::sphere, py::arg("radius"),
                  "Returns a ball around the tip.")
      .def_static(
          "capsule",
          [](const py::object& start, const py::object& end, double radius) {
            return ConvexTool::capsule(point(start, "start"), point(end, "end"), radius);
          },
          py::arg("start"), py::arg("end"), py::arg("radius"),
          "Returns the points within `radius` of the segment between two points (3,).")
      .def_static(
          "box",
          [](const py::object& low, const py::object& high) {
            return ConvexTool::box({point(low, "low"), point(high, "high")});
          },
          py::arg("low"), py::arg("high"),
          "Returns a box along the axes, between two corners (3,).")
      .def_static("hull", &hull, py::arg("points"), py::arg("radius") = 0.0,
                  "Returns the points within `radius` of the convex hull of points (n, 3), in\n"
                  "any order.")
      .def_static("of_text", &tool_of_text, py::arg("text"), text_doc)
      .def("rotated", &rotated, py::arg("rotation"),
           "Returns the tool turned about the tip by a rotation matrix (3, 3).")
      .def_property_readonly("points", &core_of,
                             "(n, 3) float64: the points of the core, as given [length].")
      .def_property_readonly("radius", &ConvexTool::radius,
                             "The radius by which the core is grown [length].")
      .def("__repr__", [](const ConvexTool& self) {
        return py::str("<keepout.ConvexTool of {} points, radius {:g}>")
            .format(self.points().size(), self.radius());
      });
}

}  // namespace keepout::python
