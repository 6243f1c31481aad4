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
    R"(A part of an instrument that shall keep clear: all within `radius` of the convex hull of its
points. One point is a ball, two are a capsule, more are a blade. The points of a capsule may be
on different links: a shaft from its port to its wrist.

name: for messages. points: 1 to 8 pairs (link, (x, y, z)) of a link's number, 0 being the base,
and a point in its frame [length]. radius: [length], not below 0.)";

constexpr const char* instrument_doc =
    R"(A chain, and what it carries: 1 to 16 bodies, of at most 48 points that differ.)";

}  // namespace

void bind_instrument(py::module_& module) {
  py::class_<Body>(module, "Body", body_doc)
      .def(py::init(&body_of), py::arg("name"), py::arg("points"), py::arg("radius"))
      .def_readonly("name", &Body::name, "For messages.")
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
          "A list of pairs (link, (x, y, z)) [length].")
      .def_readonly("radius", &Body::radius, "[length]")
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
          "chain", [](const Instrument& self) { return self.chain(); }, "Its Chain.")
      .def_property_readonly(
          "bodies",
          [](const Instrument& self) {
            return std::vector<Body>(self.bodies().begin(), self.bodies().end());
          },
          "A list of Body.")
      .def(
          "recommended_band", &recommended_band, py::arg("period"), py::arg("least") = 0.002,
          "A band for InstrumentGuard that absorbs the curvature of every motion that the joints'\n"
          "limits admit in a cycle of `period` [s]; at least `least` [length]. Infinite without\n"
          "limits.")
      .def("__repr__", [](const Instrument& self) {
        return py::str("<keepout.Instrument: {} bodies on {} joints>")
            .format(self.bodies().size(), self.chain().size());
      });
  module.def(
      "free_ball", &free_ball, py::arg("radius"),
      "The Instrument that is the ball of a tool's tip, on three joints that slide along the\n"
      "axes without limits: q is where its center is. radius: [length]");
}

}  // namespace keepout::python
