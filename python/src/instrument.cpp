// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/instrument.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "keepout/robot/instrument_constraint.h"

namespace keepout::python {
namespace {

Body body_of(std::string name, const py::iterable& points, double radius) {
  Body body{.name = std::move(name), .radius = radius};
  for (const py::handle given : points) {
    body.points.push_back(link_point(given, "points[" + std::to_string(body.points.size()) + "]"));
  }
  return body;
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
      "free_ball", &free_ball, py::arg("radius"),
      "Returns an Instrument for a ball-shaped tool tip: a ball on three prismatic joints along\n"
      "the axes, without limits. q is the position of its center.\n"
      "\n"
      "radius: [length].");
}

}  // namespace keepout::python
