// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arrays.h"
#include "keepout/activation/free_polytope.h"
#include "keepout/geometry/shapes.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/step/guide.h"
#include "keepout/step/motion.h"

namespace keepout::python {

namespace py = pybind11;

/// The mesh of a keepout.Mesh, with the messages from loading its file. Also stores the normals
/// after their first use.
struct MeshHandle : LoadedMesh {
  std::vector<Vec3> normals = {};  // one for each triangle; empty before their first use
};

/// Returns the mesh of a keepout.Mesh. Throws Error for any other object.
const std::shared_ptr<const Mesh>& mesh_of(const py::object& mesh);

/// An index and its mesh, which all users share.
struct IndexHandle {
  /// Builds the index named `part` on a keepout.Mesh, without Python's lock. `cache`: a directory
  /// that keeps built indices, or empty. Throws Error like mesh_of().
  IndexHandle(py::object on, std::string part, const std::optional<std::filesystem::path>& cache);
  /// Makes an index of the same type on a keepout.Mesh whose vertices have moved. Uses `before` if
  /// that is faster than a build. Throws Error like mesh_of(), and if the triangles differ.
  IndexHandle(py::object moved, const IndexHandle& before);

  const py::object mesh_object;
  const std::shared_ptr<const Mesh> mesh;
  const std::string name;
  const std::shared_ptr<const SpatialIndex> index;
};

/// Returns `index` if it is a keepout.Index of this mesh, or a new index if it is a name: see
/// IndexHandle. Throws Error for any other object.
std::shared_ptr<IndexHandle> index_from(const py::object& mesh, const py::object& index,
                                        const std::optional<std::filesystem::path>& cache);

/// Returns the guides of a list or tuple of keepout.Guide and texts. Throws Error for any other
/// object.
std::vector<Guide> guides_from(const py::object& given);

/// Returns the member of keepout.Status.
py::object status_object(Status status);

/// Half-spaces that outlive their step.
struct Planes {
  std::vector<HalfSpace> planes;
};

/// The result of a query for a free polytope.
struct FreeSpace : Planes {
  Status status = Status::invalid_input;

  bool ok() const noexcept { return is_ok(status); }
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::polytope); }
};

/// A step that stays valid after the next one. Its members hide the views of Step with the same
/// names, and own their contents.
struct StepResult : Step {
  std::vector<double> increment;
  Planes planes;
  std::vector<std::uint32_t> active;
  std::vector<GuideState> guides;
};

/// Returns the names of all limits in a set.
py::tuple names_of(Limits limits);

/// Adds the properties `status` and `reason` of a result.
template <class Class>
void bind_ending(Class& type, const char* status_doc) {
  using Result = typename Class::type;
  type.def_property_readonly(
          "status", [](const Result& self) { return status_object(self.status); }, status_doc)
      .def_property_readonly(
          "reason", [](const Result& self) { return self.reason(); },
          "One line on what happened and what to do about it.");
}

/// Adds the members that the steps of a tip and of an instrument have.
template <class Class>
void bind_step_result(Class& type, const char* ok_doc) {
  using Result = typename Class::type;
  bind_ending(type, "The outcome of the step: a Status.");
  type.def_property_readonly(
          "ok", [](const Result& self) { return self.ok(); }, ok_doc)
      .def_property_readonly(
          "increment",
          [](const py::object& self) { return view(self.cast<const Result&>().increment, self); },
          "(n,) float64: the increment of the joints, or of the tip of a MotionConstraint\n"
          "without a Jacobian [rad or length]. Unless ok: zeros for an instrument, empty for a\n"
          "tip.")
      .def_readonly("guides", &Result::guides,
                    "The state of each guide, in the order of set_guides: a list of GuideState.")
      .def_property_readonly(
          "relaxation", [](const Result& self) { return name(self.relaxation); },
          "The constraints that were relaxed because not all could be met: 'none', 'guides' or\n"
          "'recovery'.")
      .def_property_readonly(
          "limits", [](const Result& self) { return names_of(self.limits); },
          "The causes of a difference from the commanded motion: a tuple of names such as\n"
          "'mesh' or 'joint_velocity'.");
}

// Each function adds one concept to the module. A type must be bound before functions that take it.
void bind_status(py::module_& module);
void bind_inspection(py::module_& module);
void bind_mesh(py::module_& module);
void bind_index(py::module_& module);
void bind_guides(py::module_& module);
void bind_options(py::module_& module);
void bind_planes(py::module_& module);
void bind_step(py::module_& module);
void bind_convex_tool(py::module_& module);
void bind_motion_constraint(py::module_& module);
void bind_chain(py::module_& module);
void bind_instrument(py::module_& module);
void bind_instrument_guard(py::module_& module);
void bind_instrument_results(py::module_& module);
void bind_registration(py::module_& module);
void bind_session(py::module_& module);

/// Replaces the message for a call that fits no signature: the new message names the wrong
/// argument. Must be called last.
void explain_call_errors(py::module_& module);

}  // namespace keepout::python
