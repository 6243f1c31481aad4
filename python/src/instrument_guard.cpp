// SPDX-License-Identifier: BSD-3-Clause
#include "instrument_guard.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

#include "batch.h"

namespace keepout::python {
namespace {

std::span<const double> numbers_of(const Doubles& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

Twist twist_of(const py::object& linear, const py::object& angular) {
  Twist twist;
  if (!linear.is_none()) twist.linear = point(linear, "linear");
  if (!angular.is_none()) twist.angular = point(angular, "angular");
  return twist;
}

/// Returns row i, or the only row, which serves all.
std::span<const double> row_of(const Doubles& rows, std::size_t i, std::size_t width) {
  return numbers_of(rows).subspan(rows.ndim() == 1 ? 0 : i * width, width);
}

}  // namespace

InstrumentGuard::InstrumentGuard(std::shared_ptr<IndexHandle> index, Instrument instrument,
                                 InstrumentConstraintSettings settings)
    : GuardOf(std::move(index), std::move(settings),
              [&](const auto& on, const auto& made_as) {
                return make_instrument_constraint(on->mesh, on->index, instrument, made_as);
              }),
      instrument_(std::move(instrument)) {}

InstrumentConstraint InstrumentGuard::made_anew() const {
  InstrumentConstraint made =
      make_instrument_constraint(index()->mesh, index()->index, instrument_, settings_);
  for (std::size_t m = 1; m < meshes_.size(); ++m) {
    made.add_mesh(meshes_[m].index->mesh, meshes_[m].index->index, meshes_[m].margin);
  }
  return made;
}

Doubles InstrumentGuard::of_joints(const py::object& argument, std::string_view name) const {
  return doubles(argument, {name, {joints()}, "(" + std::to_string(joints()) + ",)"});
}

InstrumentStepResult InstrumentGuard::step(const py::object& q, const py::object& linear,
                                           const py::object& angular, const py::object& increment,
                                           const py::object& weights) {
  const Doubles at = of_joints(q, "q");
  const bool has_twist = !linear.is_none() || !angular.is_none();
  if (has_twist != increment.is_none()) {
    refuse("increment", "either an increment of the joints, or 'linear' or 'angular' of the flange",
           has_twist ? "both" : "neither");
  }
  if (has_twist && !weights.is_none()) {
    refuse("weights",
           "None with 'linear' or 'angular': only an increment of the joints has weights",
           "weights");
  }
  const auto joints = static_cast<std::size_t>(at.size());
  const auto result = [&](const InstrumentStep& step) {
    InstrumentStepResult kept{step,
                              std::vector<double>(joints, 0.0),
                              {step.guides.begin(), step.guides.end()},
                              {step.degraded.begin(), step.degraded.end()}};
    std::copy(step.increment.begin(), step.increment.end(), kept.increment.begin());
    return kept;
  };
  if (has_twist) {
    const Twist twist = twist_of(linear, angular);
    const InUse in_use(constraint_in_use_);
    return result(constraint_.step(numbers_of(at), twist));
  }
  const Doubles wanted = of_joints(increment, "increment");
  const Doubles weighed = weights.is_none() ? Doubles(0) : of_joints(weights, "weights");
  const InUse in_use(constraint_in_use_);
  return result(constraint_.step(numbers_of(at), numbers_of(wanted), numbers_of(weighed)));
}

template <class Take>
void InstrumentGuard::prove_each(const Doubles& q, const Doubles& increments, std::size_t count,
                                 unsigned threads, const Take& take) {
  const auto width = static_cast<std::size_t>(joints());
  std::vector<Pose> places;
  {
    const InUse no_step(constraint_in_use_);
    for (std::size_t m = 0; m < meshes_.size(); ++m) places.push_back(constraint_.place_of(m));
  }
  do_each(count, 16, threads,
          [&](InstrumentConstraint& constraint, std::size_t i, const std::stop_token&) {
            // The result must not depend on the worker's previous proof.
            constraint.forget();
            for (std::size_t m = 0; m < places.size(); ++m) constraint.place(m, places[m]);
            take(i, constraint.prove(row_of(q, i, width), row_of(increments, i, width)));
          });
}

MotionProof InstrumentGuard::prove(const py::object& q, const py::object& increment) {
  const Doubles at = of_joints(q, "q");
  const Doubles by = of_joints(increment, "increment");
  MotionProof result;
  prove_each(at, by, 1, 1, [&](std::size_t, const MotionProof& proof) { result = proof; });
  return result;
}

py::object InstrumentGuard::proofs(const py::object& q, const py::object& increments,
                                   std::optional<py::ssize_t> threads) {
  const py::ssize_t n = joints();
  const std::string width = std::to_string(n);
  const std::string text = "(m, " + width + ") or (" + width + ",)";
  const Doubles at = doubles(q, {"q", {any, n}, text, OneForAll::allowed});
  Doubles by(n);
  std::fill_n(by.mutable_data(), n, 0.0);
  if (!increments.is_none()) {
    by = doubles(increments, {"increments", {any, n}, text, OneForAll::allowed});
  }
  if (at.ndim() == 2 && by.ndim() == 2 && at.shape(0) != by.shape(0)) {
    refuse("increments", "as many as q, " + std::to_string(at.shape(0)) + ", or one for all",
           "shape " + shape_text(by));
  }
  const py::ssize_t count = at.ndim() == 2 ? at.shape(0) : by.ndim() == 2 ? by.shape(0) : 1;
  py::array_t<std::uint8_t> status(count);
  py::array_t<double> fraction(count);
  py::array_t<double> distance(count);
  const auto take = [statuses = status.mutable_data(), shares = fraction.mutable_data(),
                     distances = distance.mutable_data()](std::size_t i, const MotionProof& proof) {
    statuses[i] = static_cast<std::uint8_t>(proof.status);
    shares[i] = proof.fraction;
    distances[i] = proof.distance.value_or(std::nan(""));
  };
  const auto motions = static_cast<std::size_t>(count);
  prove_each(at, by, motions, threads_for(motions, threads), take);
  return py::module_::import("keepout._results").attr("Proofs")(status, fraction, distance);
}

void InstrumentGuard::follow(std::shared_ptr<IndexHandle> index, std::size_t mesh) {
  require_mesh(mesh);
  replace_mesh(mesh, index, [&] { constraint_.follow(index->mesh, index->index, mesh); });
}

std::size_t InstrumentGuard::add_mesh(std::shared_ptr<IndexHandle> index, double margin) {
  if (!index) refuse("index", "a keepout.Index", "None");
  const InUse no_proof(workers_.in_use());
  const InUse no_step(constraint_in_use_);
  const std::size_t number = constraint_.add_mesh(index->mesh, index->index, margin);
  workers_.constraints().clear();
  meshes_.push_back({std::move(index), margin});
  return number;
}

void InstrumentGuard::place(std::size_t mesh, const py::object& pose, const py::object& linear,
                            const py::object& angular) {
  const Twist velocity = twist_of(linear, angular);
  const Pose at = pose_of(pose, "pose");
  require_mesh(mesh);
  const InUse no_step(constraint_in_use_);
  if (is_ok(constraint_.place(mesh, at, velocity))) return;
  refuse("pose", "a rotation and a position, and speeds, that are plausible beside the mesh",
         "one that is not: it keeps its previous pose, and steps are invalid_input until it has a "
         "valid one");
}

py::array_t<double> InstrumentGuard::place_of(std::size_t mesh) {
  require_mesh(mesh);
  const InUse no_step(constraint_in_use_);
  return matrix_of(constraint_.place_of(mesh));
}

void InstrumentGuard::require_mesh(std::size_t mesh) const {
  if (mesh < meshes_.size()) return;
  refuse("mesh", "the number of a mesh, 0 to " + std::to_string(meshes_.size() - 1),
         std::to_string(mesh));
}

namespace {

constexpr const char* guard_doc =
    R"(Keeps a whole instrument out of a mesh, in joint space. A step returns the joint increment
nearest to the desired one that provably keeps each body clear during the actual joint motion.

Several threads may use a guard; they wait for each other. Make one guard for each parallel loop;
the guards may share the Index.

index, index_cache: as in MotionConstraint. A max_... is a capacity: a cycle that needs more ends
with Status.over_capacity.)";

constexpr const char* guard_signature =
    "__init__(self: keepout.InstrumentGuard, mesh: keepout.Mesh, instrument: keepout.Instrument, "
    "*, "
    "index: str | keepout.Index = 'wide_bvh', index_cache: str | os.PathLike[str] | None = None";

constexpr const char* joint_step_doc =
    R"(Returns the motion that the joints may make in this cycle: an InstrumentStep. Give either a
desired motion of the flange (linear, angular) or a desired increment of the joints. A number that
is not finite gives Status.invalid_input.

q: (n,), joint positions [rad or length].
linear: (3,), displacement of the flange's origin [length].
angular: (3,), rotation of the flange, axis times angle, in the axes of the mesh [rad]. If only
linear or only angular is given, the other is zero.
increment: (n,), of the joints.
weights: (n,), above 0, the cost of each joint's deviation from it; None: all 1.)";

constexpr const char* prove_doc =
    R"(Returns the certified part of a motion, for planners: a MotionProof. Does not search for a better
motion and ignores joint limits. Does not affect the steps. A number that is not finite gives
Status.invalid_input.

q: (n,), the start.
increment: (n,), of any size; zeros test a configuration.)";

constexpr const char* proofs_doc =
    R"(Like prove(), for m independent motions: returns a Proofs. The result does not depend on the
order or on the number of threads. Runs without Python's lock.

q: (m, n).
increments: (m, n); None for zeros.
threads: 1 to 1024; None: one for each processor.

A single row (n,) of either array serves all rows of the other.)";

std::unique_ptr<InstrumentGuard> make_instrument_guard(
    const py::object& mesh, const Instrument& instrument, const py::object& index,
    const std::optional<std::filesystem::path>& index_cache, const py::kwargs& given) {
  auto settings = settings_from<InstrumentConstraintSettings>(
      "InstrumentGuard", given, {"mesh", "instrument", "index", "index_cache"});
  return std::make_unique<InstrumentGuard>(index_from(mesh, index, index_cache), instrument,
                                           std::move(settings));
}

void bind_meshes(py::class_<InstrumentGuard>& type) {
  type.def("follow", &InstrumentGuard::follow, py::arg("index"), py::kw_only(), py::arg("mesh") = 0,
           "Follows a mesh that has deformed. Takes an Index of the deformed mesh, such as\n"
           "index.refitted(mesh). All bodies are classified again. A body that is now too close\n"
           "recovers.\n"
           "\n"
           "mesh: the number of the mesh, which keeps its pose.")
      .def("add_mesh", &InstrumentGuard::add_mesh, py::arg("index"), py::kw_only(),
           py::arg("margin") = 0.0,
           "Adds the mesh of an Index, and returns its number. The first mesh has number 0. At\n"
           "most 8 meshes.\n"
           "\n"
           "margin: for this mesh [length]; 0: the margin of the guard.")
      .def("place", &InstrumentGuard::place, py::arg("mesh"), py::arg("pose"),
           py::arg("linear") = py::none(), py::arg("angular") = py::none(),
           "Sets the pose of a mesh at the start of the next cycle, and its velocity: of its\n"
           "frame's origin [length/s], and of the rotation about that origin [rad/s]. The\n"
           "index is not rebuilt. The mesh moves with that velocity until it is placed again. "
           "Raises Error\n"
           "for an invalid pose or velocity; steps then return Status.invalid_input until a\n"
           "valid one is set.\n"
           "\n"
           "pose: (4, 4), the mesh's frame in the world; None is the identity.\n"
           "linear, angular: (3,), in the axes of the world; None is zero.")
      .def("place_of", &InstrumentGuard::place_of, py::arg("mesh"),
           "Returns (4, 4) float64: the pose of a mesh at the start of the next cycle.")
      .def_property_readonly("mesh_count", &InstrumentGuard::mesh_count, "The number of meshes.");
}

}  // namespace

void bind_instrument_guard(py::module_& module) {
  const std::string doc = documented<InstrumentConstraintSettings>(guard_doc);
  py::class_<InstrumentGuard> type(module, "InstrumentGuard", doc.c_str());
  bind_guard<InstrumentConstraintSettings>(
      type, "InstrumentGuard", guard_signature, py::init(&make_instrument_guard), py::arg("mesh"),
      py::arg("instrument"), py::kw_only(), py::arg("index") = "wide_bvh",
      py::arg("index_cache") = py::none());
  bind_meshes(type);
  type.def("step", &InstrumentGuard::step, py::arg("q"), py::arg("linear") = py::none(),
           py::arg("angular") = py::none(), py::kw_only(), py::arg("increment") = py::none(),
           py::arg("weights") = py::none(), joint_step_doc)
      .def("prove", &InstrumentGuard::prove, py::arg("q"), py::arg("increment"), prove_doc)
      .def("proofs", &InstrumentGuard::proofs, py::arg("q"), py::arg("increments") = py::none(),
           py::kw_only(), py::arg("threads") = py::none(), proofs_doc)
      .def_property_readonly("instrument", &InstrumentGuard::instrument, "The Instrument.")
      .def("__repr__", [](const InstrumentGuard& self) {
        const InstrumentConstraintSettings& s = self.settings();
        return py::str(
                   "<keepout.InstrumentGuard of {} bodies index='{}' solver='{}' margin={:g} "
                   "band={:g} on {} triangles>")
            .format(self.instrument().bodies().size(), self.index()->name, s.solver,
                    s.options.margin, s.options.band, self.index()->mesh->triangle_count());
      });
}

}  // namespace keepout::python
