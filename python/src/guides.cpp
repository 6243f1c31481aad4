// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "keepout/factory/guide_text.h"
#include "keepout/step/guide.h"

namespace keepout::python {
namespace {

constexpr const char* region_doc =
    R"(A convex region for a Guide, in the frame and the unit of the mesh. Made by half_space, slab,
tube or ball. Directions may have any length above 0.)";

constexpr const char* guide_doc =
    R"(A guidance constraint (guidance virtual fixture): keeps a tip, or a part of an instrument, in
a convex region. Several guides may act together; each holds on the whole executed motion.

Made by point, axis, remote_center, orientation or of_text, for InstrumentGuard.set_guides.
MotionConstraint.set_guides accepts only point(name, region), a guide for the tip.

name: for messages.
link: the number of a link, from 1; 0 is the base. Points and axes of a link are in its frame
[length]; other points, directions and rotations are in the frame of the mesh.)";

constexpr const char* guide_text_doc =
    R"(Returns a guide from a text [NAME=]FORM, as in 'keepout replay --guide' and 'keepout serve'.
Commas separate numbers; colons separate fields.

For a tip, FORM is a region: 'half_space:X,Y,Z:INTO', 'slab:X,Y,Z:NORMAL:HALF_WIDTH',
'tube:X,Y,Z:DIRECTION:RADIUS' or 'ball:X,Y,Z:RADIUS'. For an instrument: 'point:LINK:X,Y,Z:REGION',
'axis:LINK:AXIS:DIRECTION:ANGLE' or 'remote_center:LINK:X,Y,Z:LINK:X,Y,Z:CENTER:TOLERANCE'.)";

std::string_view guide_kind(const Guide& guide) {
  constexpr std::array<std::string_view, 3> names{"point", "axis", "shaft"};
  return names[static_cast<std::size_t>(guide.kind())];
}

void bind_states(py::module_& module) {
  py::class_<GuideState>(module, "GuideState", "The state of a guide in a step.")
      .def_readonly("excess", &GuideState::excess,
                    "Distance from the region at the start of the step; below 0 inside [length;\n"
                    "rad, nearly, for an axis].")
      .def_readonly("limits", &GuideState::limits, "True if the guide limits the motion.")
      .def_readonly("relaxed", &GuideState::relaxed,
                    "True if the guide does not pull its point back, because other constraints\n"
                    "contradict it.")
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
          py::arg("point"), py::arg("into"),
          "Returns the side of a plane through `point` (3,) that `into` (3,) points to.")
      .def_static(
          "slab",
          [](const py::object& at, const py::object& normal, double half_width) {
            return Region::slab(point(at, "point"), point(normal, "normal"), half_width);
          },
          py::arg("point"), py::arg("normal"), py::arg("half_width"),
          "Returns the points within half_width of a plane through `point` (3,) with the normal\n"
          "`normal` (3,) [length].")
      .def_static(
          "tube",
          [](const py::object& at, const py::object& direction, double radius) {
            return Region::tube(point(at, "point"), point(direction, "direction"), radius);
          },
          py::arg("point"), py::arg("direction"), py::arg("radius"),
          "Returns the points within `radius` of the line through `point` (3,) along\n"
          "`direction` (3,) [length].")
      .def_static(
          "ball",
          [](const py::object& center, double radius) {
            return Region::ball(point(center, "center"), radius);
          },
          py::arg("center"), py::arg("radius"),
          "Returns the points within `radius` of `center` (3,) [length].")
      .def(
          "excess",
          [](const Region& self, const py::object& at) { return self.excess(point(at, "point")); },
          py::arg("point"),
          "Returns the distance of a point (3,) from the region; below 0 inside [length].");
}

/// Adds the functions that make guides for links.
void bind_link_guides(py::class_<Guide>& type) {
  type.def_static(
          "point",
          [](const std::string& name, int link, const py::object& position, const Region& region) {
            return Guide::point(name, {link, point(position, "position")}, region);
          },
          py::arg("name"), py::arg("link"), py::arg("position"), py::arg("region"),
          "Returns a guide that keeps a point (3,) of a link in a Region.")
      .def_static(
          "axis",
          [](const std::string& name, int link, const py::object& axis, const py::object& direction,
             double angle) {
            return Guide::axis(name, link, point(axis, "axis"), point(direction, "direction"),
                               angle);
          },
          py::arg("name"), py::arg("link"), py::arg("axis"), py::arg("direction"), py::arg("angle"),
          "Returns a guide that keeps an axis (3,) of a link within `angle` of a direction (3,)\n"
          "[rad].")
      .def_static(
          "remote_center",
          [](const std::string& name, const py::object& from, const py::object& to,
             const py::object& center, double tolerance) {
            return Guide::remote_center(name, link_point(from, "from_"), link_point(to, "to"),
                                        point(center, "center"), tolerance);
          },
          py::arg("name"), py::arg("from_"), py::arg("to"), py::arg("center"), py::arg("tolerance"),
          "Returns a guide for a remote center of motion. The straight shaft between two\n"
          "points, each a pair (link, (x, y, z)), passes within `tolerance` of `center` (3,),\n"
          "such as a trocar [length].")
      .def_static(
          "orientation",
          [](const std::string& name, int link, const py::object& kept, double angle) {
            return Guide::orientation(name, link, rotation(kept), angle);
          },
          py::arg("name"), py::arg("link"), py::arg("rotation"), py::arg("angle"),
          "Returns a list of three guides, one for each axis, that keep the orientation of a\n"
          "link within `angle` of a rotation matrix (3, 3) [rad].");
}

}  // namespace

std::vector<Guide> guides_from(const py::object& given) {
  if (!PyList_Check(given.ptr()) && !PyTuple_Check(given.ptr())) {
    refuse("guides", "a list of guides", type_name(given));
  }
  std::vector<Guide> guides;
  for (const py::handle item : given) {
    if (py::isinstance<Guide>(item)) {
      guides.push_back(item.cast<Guide>());
    } else if (py::isinstance<py::str>(item)) {
      guides.push_back(guide_of_text(item.cast<std::string>()));
    } else {
      refuse("guides[" + std::to_string(guides.size()) + "]",
             "a keepout.Guide or the text of one, such as 'ball:0,0,50:20'", type_name(item));
    }
  }
  return guides;
}

void bind_guides(py::module_& module) {
  bind_states(module);
  bind_region(module);
  py::class_<Guide> type(module, "Guide", guide_doc);
  type.def_static(
      "point",
      [](const std::string& name, const Region& region) { return Guide::point(name, region); },
      py::arg("name"), py::arg("region"),
      "Returns a guide that keeps the tip of a MotionConstraint in a Region.");
  bind_link_guides(type);
  type.def_static("of_text", &guide_of_text, py::arg("text"), guide_text_doc)
      .def("with_band", &Guide::with_band, py::arg("band"),
           "Returns the guide with another band [length or rad].")
      .def_property_readonly("name", &Guide::name, "The name, for messages.")
      .def_property_readonly("kind", &guide_kind,
                             "The guided quantity: 'point', 'axis' or 'shaft'.")
      .def_property_readonly("region", &Guide::region,
                             "The region; for an axis, it bounds the tips of unit vectors.")
      .def_property_readonly("band", &Guide::band,
                             "Curvature allowance: how far a motion may leave the region\n"
                             "[length or rad].")
      .def("__repr__", [](const Guide& self) {
        return py::str("<keepout.Guide '{}' of {} {}>")
            .format(self.name(), self.kind() == Guide::Kind::axis ? "an" : "a", guide_kind(self));
      });
}

}  // namespace keepout::python
