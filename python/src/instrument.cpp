// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/instrument.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "keepout/error.h"
#include "keepout/robot/instrument_constraint.h"
#if KEEPOUT_HAS_URDF
#include "keepout/urdf/read_robot.h"
#endif

namespace keepout::python {
namespace {

Body body_of(std::string name, const py::iterable& points, double radius) {
  Body body{.name = std::move(name), .radius = radius};
  for (const py::handle given : points) {
    body.points.push_back(link_point(given, "points[" + std::to_string(body.points.size()) + "]"));
  }
  return body;
}

Instrument instrument_of_files([[maybe_unused]] const std::filesystem::path& path,
                               [[maybe_unused]] const std::optional<std::filesystem::path>& bodies,
                               [[maybe_unused]] const std::string& base,
                               [[maybe_unused]] const std::string& tip,
                               [[maybe_unused]] double scale) {
#if KEEPOUT_HAS_URDF
  UrdfRobot read = read_robot(path, bodies.value_or(""), base, tip, scale);
  for (const std::string& notice : read.notices) warn(notice);
  return std::move(read.instrument);
#else
  throw Error(
      "read_robot: this build cannot read URDF; install liburdfdom-dev and liburdfdom-headers-dev, "
      "and rebuild the module");
#endif
}

constexpr const char* body_doc =
    R"(A part of an instrument that must keep clear of the mesh: the points within `radius` of a
convex hull. One point makes a ball, two make a capsule, more make a blade. The points of a capsule
may be on different links, as for a shaft from its port to its wrist.

name: for messages.
points: 1 to 8 pairs (link, (x, y, z)) of the number of a link (0 is the base) and a point in its
frame [length].
radius: [length], not below 0.)";

constexpr const char* instrument_doc =
    R"(A chain and the bodies that it carries: 1 to 16 bodies, with at most 48 different points.)";

}  // namespace

void bind_instrument(py::module_& module) {
  py::class_<Body>(module, "Body", body_doc)
      .def(py::init(&body_of), py::arg("name"), py::arg("points"), py::arg("radius"))
      .def_readonly("name", &Body::name, "The name, for messages.")
      .def_property_readonly(
          "points",
          [](const Body& self) {
            py::list points;
            for (const LinkPoint& p : self.points) {
              points.append(py::make_tuple(
                  p.link, py::make_tuple(p.position.x(), p.position.y(), p.position.z())));
            }
            return points;
          },
          "The points: a list of pairs (link, (x, y, z)) [length].")
      .def_readonly("radius", &Body::radius, "The radius [length].")
      .def("__repr__", [](const Body& self) {
        return py::str("<keepout.Body '{}' of {} points, radius {:g}>")
            .format(self.name, self.points.size(), self.radius);
      });

  py::class_<Instrument>(module, "Instrument", instrument_doc)
      .def(py::init([](const Chain& chain, std::vector<Body> bodies) {
             return Instrument(chain, std::move(bodies));
           }),
           py::arg("chain"), py::arg("bodies"))
      .def_property_readonly(
          "chain", [](const Instrument& self) { return self.chain(); }, "The Chain.")
      .def_property_readonly(
          "bodies",
          [](const Instrument& self) {
            return std::vector<Body>(self.bodies().begin(), self.bodies().end());
          },
          "The bodies: a list of Body.")
      .def("recommended_band", &recommended_band, py::arg("period"), py::arg("least") = 0.002,
           "Returns a band for InstrumentGuard that covers the curvature of every motion within\n"
           "the joint limits in a cycle of `period` [s]; at least `least` [length]. Infinite\n"
           "if the limits do not bound the curvature.")
      .def("__repr__", [](const Instrument& self) {
        return py::str("<keepout.Instrument: {} bodies on {} joints>")
            .format(self.bodies().size(), self.chain().size());
      });
  module.def(
      "read_robot", &instrument_of_files, py::arg("path"), py::arg("bodies") = py::none(),
      py::kw_only(), py::arg("base") = "", py::arg("tip") = "", py::arg("scale") = 1000.0,
      "Reads an Instrument from a URDF file and a JSON file of its bodies: docs/robots.md. Raises\n"
      "Error if this build cannot read URDF.\n"
      "\n"
      "bodies: None, or a file without bodies: each collision element becomes a body, a capsule\n"
      "that contains it. A Python warning names the links that no body guards.\n"
      "base, tip: as in read_chain; empty for those of the JSON file.\n"
      "scale: the length of a meter in the unit of the mesh.");
  module.def(
      "free_ball", &free_ball, py::arg("radius"),
      "Returns an Instrument for a ball-shaped tool tip: a ball on three prismatic joints along\n"
      "the axes, without limits. q is the position of its center.\n"
      "\n"
      "radius: [length].");
}

}  // namespace keepout::python
