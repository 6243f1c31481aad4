// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <array>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"

namespace keepout::python {
namespace {

/// The members of keepout.Status. Never released: the interpreter may end before static objects.
std::array<PyObject*, status_count> members{};

Status status_from(py::ssize_t value) {
  if (value < 0 || static_cast<std::size_t>(value) >= status_count) {
    refuse("status", "0 to " + std::to_string(status_count - 1), std::to_string(value));
  }
  return static_cast<Status>(value);
}

Subject subject_from(const std::string& name) {
  if (name == "tip") return Subject::tip;
  if (name == "instrument") return Subject::instrument;
  if (name == "polytope") return Subject::polytope;
  refuse("subject", "'tip', 'instrument' or 'polytope'", "'" + name + "'");
}

}  // namespace

py::tuple names_of(Limits limits) {
  py::list names;
  for (std::size_t i = 0; i < limit_count; ++i) {
    const auto limit = static_cast<Limit>(i);
    if (limits.has(limit)) names.append(py::str(name(limit)));
  }
  return py::tuple(names);
}

py::object status_object(Status status) {
  return py::reinterpret_borrow<py::object>(members[static_cast<std::size_t>(status)]);
}

void bind_status(py::module_& module) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < status_count; ++i) {
    names.emplace_back(name(static_cast<Status>(i)));
  }
  module.attr("_status_names") = py::tuple(py::cast(names));
  module.def(
      "_status_reason",
      [](py::ssize_t value, const std::string& subject) {
        return reason(status_from(value), subject_from(subject));
      },
      py::arg("status"), py::arg("subject"),
      "Returns one line on what a status means for a subject, and what to do about it.");
  // The enumeration is a Python class, because numpy compares its members quickly.
  const py::object type = py::module_::import("keepout._results").attr("Status");
  for (std::size_t i = 0; i < status_count; ++i) members[i] = type(i).release().ptr();
}

void bind_planes(py::module_& module) {
  py::class_<Planes> planes(
      module, "Planes",
      "Half-spaces: a motion d is allowed if normals @ d >= offsets. Arrays are read-only\n"
      "views.");
  add_view(
      planes, "normals", &Planes::planes, 3,
      [](const HalfSpace& plane) { return plane.normal.data(); },
      "(k, 3) float64: unit normals, towards the free side.");
  add_view(
      planes, "offsets", &Planes::planes, 1, [](const HalfSpace& plane) { return &plane.offset; },
      "(k,) float64, relative to the tip: a plane with an offset above 0 requires a retreat\n"
      "[length].");
  add_view(
      planes, "sources", &Planes::planes, 1, [](const HalfSpace& plane) { return &plane.source; },
      "(k,) uint32: the triangle of each plane.");
  planes.def("__len__", [](const Planes& self) { return self.planes.size(); })
      .def("__repr__", [](const Planes& self) {
        return "<keepout.Planes: " + std::to_string(self.planes.size()) + ">";
      });

  py::class_<FreeSpace, Planes> polytope(
      module, "Polytope",
      "The free space around a tip as planes: see MotionConstraint.free_polytope. If it is not\n"
      "ok, it allows zero motion only.");
  bind_ending(polytope, "Status.free if the planes are complete; otherwise the cause.");
  polytope
      .def_property_readonly(
          "ok", [](const FreeSpace& self) { return self.ok(); }, "True if the planes are complete.")
      .def("__repr__", [](const FreeSpace& self) {
        return py::str("<keepout.Polytope: {}, {} planes>")
            .format(name(self.status), self.planes.size());
      });
}

void bind_step(py::module_& module) {
  py::class_<StepResult> type(module, "Step",
                              "The result of one control cycle. Arrays are read-only views of\n"
                              "it.");
  bind_step_result(type, "True if the motion may be executed; it may be zero.");
  type.def_property_readonly(
          "motion",
          [](const py::object& self) {
            return view(self.cast<const StepResult&>().motion.data(), {3}, {sizeof(double)}, self);
          },
          "(3,) float64: the motion of the tip; zero unless ok [length].")
      .def_readonly("planes", &StepResult::planes, "All planes that the solver received: a Planes.")
      .def_property_readonly(
          "active",
          [](const py::object& self) { return view(self.cast<const StepResult&>().active, self); },
          "(a,) uint32: the indices of the planes that limit the motion; those from len(planes)\n"
          "on are rows.")
      .def_readonly("triangles", &StepResult::triangles,
                    "The number of triangles that the step depends on.")
      .def_readonly(
          "distance", &StepResult::distance,
          "The distance from the tip at the start of the step to the nearest triangle [length];\n"
          "None if unknown: see the option distances.")
      .def("__repr__", [](const StepResult& self) {
        const Vec3& u = self.motion;
        return py::str("<keepout.Step: {}, motion ({}, {}, {})>")
            .format(name(self.status), u.x(), u.y(), u.z());
      });
}

}  // namespace keepout::python
