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
#include "keywords.h"
#include "poses.h"

namespace keepout::python {
namespace {

std::span<const double> numbers_of(const Doubles& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// Row i, or the only one, which stands for all.
std::span<const double> row_of(const Doubles& rows, std::size_t i, std::size_t width) {
  return numbers_of(rows).subspan(rows.ndim() == 1 ? 0 : i * width, width);
}

}  // namespace

InstrumentGuard::InstrumentGuard(std::shared_ptr<IndexHandle> index, Instrument instrument,
                                 InstrumentConstraintSettings settings)
    : meshes_{{std::move(index), 0.0}},
      instrument_(std::move(instrument)),
      settings_(std::move(settings)),
      constraint_([this] {
        const py::gil_scoped_release release;
        return make();
      }()) {}

InstrumentConstraint InstrumentGuard::make() const {
  InstrumentConstraint made =
      make_instrument_constraint(index()->mesh, index()->index, instrument_, settings_);
  for (std::size_t m = 1; m < meshes_.size(); ++m) {
    made.add_mesh(meshes_[m].index->mesh, meshes_[m].index->index, meshes_[m].margin);
  }
  made.set_guides(guides_);
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
    refuse("weights", "None without an increment of the joints, which they are for", "weights");
  }
  const auto joints = static_cast<std::size_t>(at.size());
  const auto result = [&](const InstrumentStep& step) {
    InstrumentStepResult kept{step,
                              std::vector<double>(joints, 0.0),
                              {step.guides.begin(), step.guides.end()},
                              {step.degraded.begin(), step.degraded.end()}};
    std::copy(step.increment.begin(), step.increment.end(), kept.increment.begin());
    kept.step.increment = {};
    kept.step.guides = {};
    kept.step.degraded = {};
    return kept;
  };
  if (has_twist) {
    Twist twist;
    if (!linear.is_none()) twist.linear = point(linear, "linear");
    if (!angular.is_none()) twist.angular = point(angular, "angular");
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
  workers_.do_each(
      count, 16, threads, [this] { return make(); },
      [&](InstrumentConstraint& constraint, std::size_t i, const std::stop_token&) {
        // Or the answer might depend on what this worker proved before.
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
  py::array_t<double> share(count);
  py::array_t<double> distance(count);
  const auto take = [statuses = status.mutable_data(), shares = share.mutable_data(),
                     distances = distance.mutable_data()](std::size_t i, const MotionProof& proof) {
    statuses[i] = static_cast<std::uint8_t>(proof.status);
    shares[i] = proof.share;
    distances[i] = proof.distance.value_or(std::nan(""));
  };
  const auto motions = static_cast<std::size_t>(count);
  prove_each(at, by, motions, threads_for(motions, threads), take);
  return py::module_::import("keepout._results").attr("Proofs")(status, share, distance);
}

void InstrumentGuard::forget() {
  const InUse in_use(constraint_in_use_);
  constraint_.forget();
}

void InstrumentGuard::follow(std::shared_ptr<IndexHandle> index, std::size_t mesh) {
  require_mesh(mesh);
  if (!index) refuse("index", "a keepout.Index", "None");
  const InUse no_proof(workers_.in_use());
  const InUse no_step(constraint_in_use_);
  {
    const py::gil_scoped_release release;
    constraint_.follow(index->mesh, index->index, mesh);
    workers_.constraints().clear();
  }
  meshes_[mesh].index = std::move(index);
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
  Twist velocity;
  if (!linear.is_none()) velocity.linear = point(linear, "linear");
  if (!angular.is_none()) velocity.angular = point(angular, "angular");
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

void InstrumentGuard::set_guides(const std::vector<Guide>& guides) {
  const InUse no_proof(workers_.in_use());
  const InUse no_step(constraint_in_use_);
  constraint_.set_guides(guides);  // throws for what none would take
  for (InstrumentConstraint& worker : workers_.constraints()) worker.set_guides(guides);
  guides_ = guides;
}

void InstrumentGuard::set_options(const InstrumentOptions& options) {
  const InUse no_proof(workers_.in_use());
  const InUse no_step(constraint_in_use_);
  constraint_.set_options(options);  // throws for what none would take
  for (InstrumentConstraint& worker : workers_.constraints()) worker.set_options(options);
  settings_.options = options;
}

namespace {

CertifiedMotion certified_of(const std::string& name) {
  return named<CertifiedMotion>(
      "certified", name,
      {{{"actual", CertifiedMotion::actual}, {"linearised", CertifiedMotion::linearised}}});
}

constexpr std::array<std::string_view, 19> guard_arguments = {"mesh",
                                                              "instrument",
                                                              "index",
                                                              "index_cache",
                                                              "solver",
                                                              "margin",
                                                              "band",
                                                              "period",
                                                              "recovery",
                                                              "slowing_within",
                                                              "slowing_time",
                                                              "damping",
                                                              "orientation_weight",
                                                              "refinements",
                                                              "check_sides",
                                                              "max_triangles",
                                                              "max_planes",
                                                              "max_looks",
                                                              "certified"};

constexpr const char* guard_doc =
    R"(Keeps a whole instrument out of a mesh, in joint space: the joint increment nearest to what is asked
for that provably keeps each body clear, on the motion that the joints really make. It is safe to
use from several threads, which then wait for each other; for loops of their own give each a guard,
and let them share the Index.

index, index_cache, solver: as in MotionConstraint. The rest but max_... may be set again.
margin: distance to keep beyond each body's radius [length], above the band.
band: what is held back of the margin, so that curved motions along a surface are proven: certified
is margin - band. See Instrument.recommended_band [length].
period: of a cycle: what velocity limits are multiplied by [s].
recovery: how far a body that is too close is led away in a cycle [length].
slowing_within, slowing_time: nearer to the margin than that [length], a body uses up no more of the
way left to it in a cycle than period / slowing_time [s]; 0: nowhere.
damping: weight of |dq|^2 beside the task of the flange [length^2].
orientation_weight: what a turn of the flange counts beside its way [length / rad]; 0: nothing.
refinements: how often planes are turned towards a better motion.
check_sides: whether bodies that no step has led to where they are have to be on the free side of
a watertight mesh.
certified: 'actual', the motion that the joints make, or 'linearised', which is unsafe, and for
comparison only.
max_triangles (near one body), max_planes: room for a cycle; one that needs more ends with
Status.over_capacity. max_looks: the work of a cycle; 0 for 65,536, or 4,194,304
on an index that does not walk by itself.)";

constexpr const char* joint_step_doc =
    R"(What the joints may do in this cycle: an InstrumentStep. Asked for is either a motion of the flange,
or an increment of the joints. A number that is not finite gives Status.invalid_input.

q: (n,), the joints' positions [rad or length]. linear: (3,), how the flange's origin shall move
[length]. angular: (3,), how it shall turn, axis times angle, in the mesh's axes [rad]; zero where
one of both is None. increment: (n,), of the joints. weights: (n,), above 0, what each joint's way
from it counts; all 1 when None.)";

constexpr const char* prove_doc =
    R"(How much of a motion is certified, for planners: a MotionProof. It looks for no better motion, and
not at the limits of joints. Changes nothing for the steps. A number that is not finite gives
Status.invalid_input.

q: (n,), where it starts. increment: (n,), of any size; zeros ask of the place alone.)";

constexpr const char* proofs_doc =
    R"(The same of m motions, each for itself: a Proofs, whose arrays do not depend on the order or on the
number of threads. Runs without Python's lock.

q: (m, n). increments: (m, n); None for zeros. A single one of either, (n,), serves all of the
other. threads: 1 to 1024; None for one a processor.)";

template <class Value>
void take(Value& option, const std::optional<Value>& given) {
  if (given) option = *given;
}

void set_given(InstrumentGuard& guard, std::optional<double> margin, std::optional<double> band,
               std::optional<double> period, std::optional<double> recovery,
               std::optional<double> slowing_within, std::optional<double> slowing_time,
               std::optional<double> damping, std::optional<double> orientation_weight,
               std::optional<int> refinements, std::optional<bool> check_sides,
               const std::optional<std::string>& certified) {
  InstrumentOptions options = guard.settings().options;
  take(options.margin, margin);
  take(options.band, band);
  take(options.period, period);
  take(options.recovery, recovery);
  take(options.slowing_within, slowing_within);
  take(options.slowing_time, slowing_time);
  take(options.damping, damping);
  take(options.orientation_weight, orientation_weight);
  take(options.refinements, refinements);
  take(options.check_sides, check_sides);
  if (certified) options.certified = certified_of(*certified);
  guard.set_options(options);
}

}  // namespace

void bind_instrument_guard(py::module_& module) {
  const InstrumentConstraintSettings usual;
  const InstrumentOptions& o = usual.options;
  py::class_<InstrumentGuard>(module, "InstrumentGuard", guard_doc)
      .def(py::init(
               [](const py::object& mesh, const Instrument& instrument, const py::object& index,
                  const std::optional<std::filesystem::path>& index_cache, std::string solver,
                  double margin, double band, double period, double recovery, double slowing_within,
                  double slowing_time, double damping, double orientation_weight, int refinements,
                  bool check_sides, const std::string& certified, py::ssize_t max_triangles,
                  py::ssize_t max_planes, py::ssize_t max_looks, const py::kwargs& others) {
                 refuse_others("InstrumentGuard", others, guard_arguments);
                 InstrumentConstraintSettings settings;
                 settings.solver = std::move(solver);
                 settings.options = {.margin = margin,
                                     .band = band,
                                     .period = period,
                                     .recovery = recovery,
                                     .slowing_within = slowing_within,
                                     .slowing_time = slowing_time,
                                     .damping = damping,
                                     .orientation_weight = orientation_weight,
                                     .refinements = refinements,
                                     .check_sides = check_sides,
                                     .certified = certified_of(certified)};
                 settings.capacity = {.triangles = count(max_triangles, "max_triangles"),
                                      .planes = count(max_planes, "max_planes"),
                                      .looks = count(max_looks, "max_looks")};
                 return std::make_unique<InstrumentGuard>(index_from(mesh, index, index_cache),
                                                          instrument, std::move(settings));
               }),
           py::arg("mesh"), py::arg("instrument"), py::kw_only(), py::arg("index") = usual.index,
           py::arg("index_cache") = py::none(), py::arg("solver") = usual.solver,
           py::arg("margin") = o.margin, py::arg("band") = o.band, py::arg("period") = o.period,
           py::arg("recovery") = o.recovery, py::arg("slowing_within") = o.slowing_within,
           py::arg("slowing_time") = o.slowing_time, py::arg("damping") = o.damping,
           py::arg("orientation_weight") = o.orientation_weight,
           py::arg("refinements") = o.refinements, py::arg("check_sides") = o.check_sides,
           py::arg("certified") = "actual", py::arg("max_triangles") = usual.capacity.triangles,
           py::arg("max_planes") = usual.capacity.planes,
           py::arg("max_looks") = usual.capacity.looks)
      .def("step", &InstrumentGuard::step, py::arg("q"), py::arg("linear") = py::none(),
           py::arg("angular") = py::none(), py::kw_only(), py::arg("increment") = py::none(),
           py::arg("weights") = py::none(), joint_step_doc)
      .def("prove", &InstrumentGuard::prove, py::arg("q"), py::arg("increment"), prove_doc)
      .def("proofs", &InstrumentGuard::proofs, py::arg("q"), py::arg("increments") = py::none(),
           py::kw_only(), py::arg("threads") = py::none(), proofs_doc)
      .def("forget", &InstrumentGuard::forget,
           "Forgets what the last cycle left: for motions that have nothing to do with each other.")
      .def("follow", &InstrumentGuard::follow, py::arg("index"), py::kw_only(), py::arg("mesh") = 0,
           "Goes on with anatomy that has deformed: an Index of the new mesh, such as\n"
           "index.refitted(mesh). All bodies are placed anew; one that the surface came too close\n"
           "to recovers. mesh: the number of the mesh, which stays placed as it is.")
      .def(
          "add_mesh", &InstrumentGuard::add_mesh, py::arg("index"), py::kw_only(),
          py::arg("margin") = 0.0,
          "Keeps out of one more mesh, that of an Index, and returns its number; the first has 0.\n"
          "margin: of its own [length], or 0 for that of the guard. At most 8 meshes.")
      .def(
          "place", &InstrumentGuard::place, py::arg("mesh"), py::arg("pose"),
          py::arg("linear") = py::none(), py::arg("angular") = py::none(),
          "Says where a mesh is as the next cycle begins, and how it moves: its frame's origin\n"
          "[length/s], and its turn about that [rad/s]. Nothing is built anew. It goes on so with\n"
          "every step until it is placed again. Until a pose that is none, or a number that is "
          "not\n"
          "finite, is mended, steps are Status.invalid_input. pose: (4, 4), its frame in the "
          "world;\n"
          "None is the identity. linear, angular: (3,), in the axes of the world; None is zero.")
      .def("place_of", &InstrumentGuard::place_of, py::arg("mesh"),
           "(4, 4) float64: where a mesh is, as the next cycle begins.")
      .def("set_guides", &InstrumentGuard::set_guides, py::arg("guides"),
           "Keeps these guides as well from the next step on, at most 16, instead of those there\n"
           "are: a list of Guide. They hold in proofs too.")
      .def(
          "set_options", &set_given, py::kw_only(), py::arg("margin") = py::none(),
          py::arg("band") = py::none(), py::arg("period") = py::none(),
          py::arg("recovery") = py::none(), py::arg("slowing_within") = py::none(),
          py::arg("slowing_time") = py::none(), py::arg("damping") = py::none(),
          py::arg("orientation_weight") = py::none(), py::arg("refinements") = py::none(),
          py::arg("check_sides") = py::none(), py::arg("certified") = py::none(),
          "Behaves so from the next step on; None leaves an option as it is. Changes nothing when\n"
          "it raises Error. A raised margin is come up to by recovery.")
      .def_property_readonly(
          "mesh", [](const InstrumentGuard& self) { return self.index()->mesh_object; },
          "The first mesh.")
      .def_property_readonly(
          "mesh_count", [](const InstrumentGuard& self) { return self.mesh_count(); },
          "How many meshes it is kept out of.")
      .def_property_readonly("index", &InstrumentGuard::index,
                             "The Index of the first mesh, which others may share.")
      .def_property_readonly("instrument", &InstrumentGuard::instrument, "Its Instrument.")
      .def_property_readonly(
          "margin", [](const InstrumentGuard& self) { return self.settings().options.margin; },
          "Distance to keep beyond each body's radius [length].")
      .def_property_readonly(
          "band", [](const InstrumentGuard& self) { return self.settings().options.band; },
          "What is held back of the margin [length].")
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
