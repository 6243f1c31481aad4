// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "keepout/step/guide.h"

namespace keepout::python {
namespace {

constexpr const char* region_doc =
    R"(A convex region that something is to stay in, in the world: made by half_space, slab,
tube or ball.)";

constexpr const char* guide_doc =
    R"(A guidance constraint: keeps a tip, or a part of an instrument, in a convex region. Made by
point, axis, remote_center or orientation, for MotionConstraint.set_guides (of a tip: only
point(name, region)) and InstrumentGuard.set_guides. Guides compose; each holds on the whole
executed motion.)";

void bind_states(py::module_& module) {
  py::class_<GuideState>(module, "GuideState", "The state of a guide in a step.")
      .def_readonly("excess", &GuideState::excess,
                    "How far out of its region as the step began; below 0 in it [length, or all "
                    "but rad].")
      .def_readonly("limits", &GuideState::limits, "True if it limits the motion.")
      .def_readonly("relaxed", &GuideState::relaxed,
                    "True if it does not lead back what is out, because constraints contradict it.")
      .def("__repr__", [](const GuideState& self) {
        return py::str("<keepout.GuideState: excess {:g}{}{}>")
            .format(self.excess, self.limits ? ", limits" : "", self.relaxed ? ", relaxed" : "");
      });
}

void bind_region(py::module_& module) {
  py::class_<Region>(module, "Region", region_doc)
      .def_static(
          "half_space",
          [](const py::object& at, const py::object& into) {
            return Region::half_space(point(at, "point"), point(into, "into"));
          },
          py::arg("point"), py::arg("into"), "The side of a plane that `into` (3,) points to.")
      .def_static(
          "slab",
          [](const py::object& at, const py::object& normal, double half_width) {
            return Region::slab(point(at, "point"), point(normal, "normal"), half_width);
          },
          py::arg("point"), py::arg("normal"), py::arg("half_width"),
          "All within half_width of a plane [length].")
      .def_static(
          "tube",
          [](const py::object& at, const py::object& direction, double radius) {
            return Region::tube(point(at, "point"), point(direction, "direction"), radius);
          },
          py::arg("point"), py::arg("direction"), py::arg("radius"),
          "All within a radius of a line [length].")
      .def_static(
          "ball",
          [](const py::object& center, double radius) {
            return Region::ball(point(center, "center"), radius);
          },
          py::arg("center"), py::arg("radius"), "All within a radius of a point [length].")
      .def(
          "excess",
          [](const Region& self, const py::object& at) { return self.excess(point(at, "point")); },
          py::arg("point"), "How far a point (3,) is out of it; below 0 in it [length].");
}

}  // namespace

void bind_guides(py::module_& module) {
  bind_states(module);
  bind_region(module);
  py::class_<Guide>(module, "Guide", guide_doc)
      .def_static(
          "point",
          [](std::string name, const Region& region) {
            return Guide::point(std::move(name), region);
          },
          py::arg("name"), py::arg("region"), "The tip of a MotionConstraint stays in a Region.")
      .def_static(
          "point",
          [](std::string name, int link, const py::object& position, const Region& region) {
            return Guide::point(std::move(name), {link, point(position, "position")}, region);
          },
          py::arg("name"), py::arg("link"), py::arg("position"), py::arg("region"),
          "A point of a link, (3,) in its frame, stays in a Region.")
      .def_static(
          "axis",
          [](std::string name, int link, const py::object& axis, const py::object& direction,
             double angle) {
            return Guide::axis(std::move(name), link, point(axis, "axis"),
                               point(direction, "direction"), angle);
          },
          py::arg("name"), py::arg("link"), py::arg("axis"), py::arg("direction"), py::arg("angle"),
          "A direction of a link, (3,) in its frame, stays within an angle of one in the world "
          "[rad].")
      .def_static(
          "remote_center",
          [](std::string name, const std::pair<int, py::object>& from,
             const std::pair<int, py::object>& to, const py::object& center, double tolerance) {
            return Guide::remote_center(std::move(name), {from.first, point(from.second, "from_")},
                                        {to.first, point(to.second, "to")}, point(center, "center"),
                                        tolerance);
          },
          py::arg("name"), py::arg("from_"), py::arg("to"), py::arg("center"), py::arg("tolerance"),
          "The straight shaft between two points, each a pair of a link and a place (3,) in its\n"
          "frame, passes within a tolerance of a center (3,), such as a trocar [length].")
      .def_static(
          "orientation",
          [](const std::string& name, int link, const py::object& kept, double angle) {
            return Guide::orientation(name, link, rotation(kept), angle);
          },
          py::arg("name"), py::arg("link"), py::arg("rotation"), py::arg("angle"),
          "A link keeps an orientation, (3, 3) in the world, to within an angle of any "
          "turn\n"
          "[rad]: a list of three guides, one for each axis.")
      .def("with_band", &Guide::with_band, py::arg("band"),
           "The same guide, which may be left by so much [length or rad].")
      .def_property_readonly("name", &Guide::name, "For messages.")
      .def_property_readonly("region", &Guide::region,
                             "Where it is to stay; of an axis, the tips of unit vectors.")
      .def_property_readonly("band", &Guide::band,
                             "By how much its region may be left [length or rad].");
}

}  // namespace keepout::python
