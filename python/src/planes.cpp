// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planes.h"

#include <pybind11/stl.h>

#include <string>

#include "bindings.h"
#include "views.h"

namespace keepout::python {
namespace {

const HalfSpace* first_plane(const py::object& self) {
  static const HalfSpace none{};  // of an empty list no number is read, but an address is
  const std::vector<HalfSpace>& planes = self.cast<const Planes&>().planes;
  return planes.empty() ? &none : planes.data();
}

/// The members of the planes as arrays, in place: of whichever class holds them.
template <class Class>
void add_columns(Class& type) {
  const auto size = [](const py::object& self) {
    return static_cast<py::ssize_t>(self.cast<const Planes&>().planes.size());
  };
  type.def_property_readonly(
          "normals",
          [size](const py::object& self) {
            return view(first_plane(self)->normal.data(), {size(self), 3},
                        {sizeof(HalfSpace), sizeof(double)}, self);
          },
          "(k, 3) float64: unit normals, towards the free side.")
      .def_property_readonly(
          "offsets",
          [size](const py::object& self) {
            return view(&first_plane(self)->offset, {size(self)}, {sizeof(HalfSpace)}, self);
          },
          "(k,) float64 [length], relative to the tip: above 0 a plane asks for a retreat.")
      .def_property_readonly(
          "sources",
          [size](const py::object& self) {
            return view(&first_plane(self)->source, {size(self)}, {sizeof(HalfSpace)}, self);
          },
          "(k,) uint32: the triangles that called for them.")
      .def("__len__", [](const Planes& self) { return self.planes.size(); });
}

}  // namespace

void bind_planes(py::module_& module) {
  py::class_<Planes> planes(
      module, "Planes",
      "Half-spaces: allowed are the motions d with normals @ d >= offsets. Arrays are read-only\n"
      "views.");
  add_columns(planes);
  planes.def("__repr__", [](const Planes& self) {
    return "<keepout.Planes: " + std::to_string(self.planes.size()) + ">";
  });

  py::class_<FreeSpace, Planes> polytope(
      module, "Polytope",
      "The free space around a tip as planes: see MotionConstraint.free_polytope. One that is not\n"
      "ok allows standing still only.");
  polytope
      .def_property_readonly(
          "status", [](const FreeSpace& self) { return name(self.status); },
          "'found', or what went wrong: 'touching', 'invalid_input', 'over_capacity', "
          "'whole_tool'.")
      .def_property_readonly(
          "ok", [](const FreeSpace& self) { return self.status == PolytopeStatus::found; },
          "Whether the planes are complete.")
      .def_property_readonly(
          "reason", [](const FreeSpace& self) { return reason(self.status); },
          "One line on what happened and what to do about it.")
      .def("__repr__", [](const FreeSpace& self) {
        return "<keepout.Polytope: " + std::string(name(self.status)) + ", " +
               std::to_string(self.planes.size()) + " planes>";
      });
}

}  // namespace keepout::python
