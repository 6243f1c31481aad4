// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/instrument_constraint.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>

#include "joint_cycle.h"
#include "joint_input.h"
#include "keepout/error.h"
#include "keepout/mesh/diagnostics.h"
#include "keepout/rounding_mode.h"
#include "keepout/step/options.h"

namespace keepout {
namespace {

std::unique_ptr<Neighborhood> neighborhood_of(std::shared_ptr<const Mesh> mesh,
                                              std::shared_ptr<const SpatialIndex> index,
                                              const InstrumentCapacity& capacity, Budget& budget) {
  if (!mesh || !index) throw Error("an instrument constraint needs a mesh and an index of it");
  if (capacity.triangles == 0) {
    option_named(instrument_capacity_options, "max_triangles").refuse("0");
  }
  return std::make_unique<Neighborhood>(std::move(mesh), std::move(index), capacity.triangles,
                                        budget);
}

Solver& required(const std::unique_ptr<Solver>& solver) {
  if (solver == nullptr) throw Error("an instrument constraint needs a solver");
  return *solver;
}

InstrumentCapacity checked(InstrumentCapacity capacity) {
  const auto& planes = option_named(instrument_capacity_options, "max_planes");
  planes.accepted(planes.get(capacity));
  if (capacity.work_units == 0) capacity.work_units = capacity.looks;
  return capacity;
}

}  // namespace

struct InstrumentConstraint::State {
  State(Instrument instrument_, std::unique_ptr<Solver> solver_, const InstrumentOptions& options_,
        const InstrumentCapacity& capacity_)
      : instrument(std::move(instrument_)),
        solver(std::move(solver_)),
        capacity(checked(capacity_)),
        memory(instrument, required(solver), capacity),
        options(options_) {}

  /// Replaces the mesh with that number, or adds it. Throws Error, and changes nothing, if the
  /// options cannot be used with it.
  void put(MeshMemory mesh, std::size_t number) {
    const std::vector<MeshMemory>::iterator at =
        memory.meshes.begin() + static_cast<std::ptrdiff_t>(number);
    const bool is_new = at == memory.meshes.end();
    if (is_new) {
      memory.meshes.push_back(std::move(mesh));
    } else {
      std::swap(*at, mesh);
    }
    try {
      prepare();
      if (monitor != nullptr) {
        monitor->follow(memory.meshes[number].neighborhood->shared_mesh(), number);
      }
    } catch (...) {
      if (is_new) {
        memory.meshes.pop_back();
      } else {
        std::swap(memory.meshes[number], mesh);
      }
      memory.measure();
      if (monitor != nullptr) prepare();
      throw;
    }
  }

  /// Prepares all memory that depends on the meshes, and forgets the last cycle. Throws Error, and
  /// forgets nothing, if the options cannot be used with the meshes.
  void prepare() {
    require_rounding_to_nearest();
    memory.measure();
    memory.require_usable(options);
    // The default is that of a tip's step, measured on wide_bvh. The largest default of all indices
    // is used.
    std::size_t work_units =
        capacity.work_units > 0 ? capacity.work_units : Capacity::work_units_of_traversals;
    for (const MeshMemory& each : memory.meshes) {
      const SpatialIndex& index = each.neighborhood->index();
      work_units =
          std::max(work_units, Capacity::work_units_or_default(capacity.work_units, index));
    }
    memory.prepare();
    memory.budget = Budget(work_units);
  }

  /// Renews the work budget. Returns free, or the status that prevents a cycle.
  Status renew_and_check(std::span<const double> q, bool is_input_valid) noexcept {
    memory.budget.renew();
    const Status status = check_start(memory, options, q);
    return is_ok(status) && !is_input_valid ? Status::invalid_input : status;
  }

  /// Runs a cycle, if it may start, for the task that `make_task` makes from the chain at its
  /// start. Moves the meshes in any case.
  template <class MakeTask>
  InstrumentStep step(std::span<const double> q, bool is_input_valid, MakeTask make_task) noexcept {
    const RoundingToNearest rounding;
    InstrumentStep result{.status = renew_and_check(q, is_input_valid)};
    if (is_ok(result.status)) {
      JointCycle cycle(memory, options, q, JointCycle::MeshMotion::predicted);
      result = cycle.run(make_task(cycle.chain_at_start()));
      if (monitor != nullptr && result.ok() && !is_confirmed(q, result)) {
        result.status = Status::unconfirmed;
        result.increment = {};
        memory.forget_motion();
      }
    }
    // Without a proved motion beside meshes that move, no clearance is certified.
    if (!result.ok() && memory.is_moving()) result.clearance_fraction = 0.0;
    move_meshes();
    result.share = result.fraction;
    result.level = result.clearance_fraction;
    return result;
  }

  /// Returns true if the monitor confirms the increment, or if nothing moves.
  bool is_confirmed(std::span<const double> q, const InstrumentStep& result) noexcept {
    const bool is_still = std::ranges::all_of(result.increment, [](double x) { return x == 0.0; });
    if (is_still && !memory.is_moving()) return true;
    for (std::size_t k = 0; k < q.size(); ++k) monitored.ends[k] = q[k] + result.increment[k];
    for (std::size_t m = 0; m < memory.meshes.size(); ++m) {
      const MeshMemory& mesh = memory.meshes[m];
      monitored.meshes[m] = {
          mesh.pose,
          {options.period * mesh.velocity.linear, options.period * mesh.velocity.angular}};
    }
    for (std::size_t p = 0; p < memory.pairs.size(); ++p) {
      const PairMemory& pair = memory.pairs[p];
      const double none = -std::numeric_limits<double>::infinity();
      const double target = memory.meshes[pair.mesh].margin(options) - options.band;
      monitored.pairs[p] = {pair.is_dropped ? none : pair.certified,
                            pair.clearance_fraction < 1.0 ? none : target, options.band};
    }
    return monitor->confirms({q,
                              {monitored.ends.data(), q.size()},
                              {monitored.meshes.data(), memory.meshes.size()},
                              {monitored.pairs.data(), memory.pairs.size()},
                              memory.tolerance});
  }

  /// Moves the meshes by their velocities.
  void move_meshes() noexcept {
    if (!memory.is_moving()) return;
    for (MeshMemory& mesh : memory.meshes) {
      mesh.pose.position += options.period * mesh.velocity.linear;
      const double turn = options.period * mesh.velocity.angular.norm();
      if (!(turn > 0.0)) continue;
      const Eigen::AngleAxisd by(turn, mesh.velocity.angular.normalized());
      mesh.pose.rotation = (by * Eigen::Quaterniond(mesh.pose.rotation)).normalized().matrix();
    }
    memory.measure();
  }

  Instrument instrument;
  std::unique_ptr<Solver> solver;
  InstrumentCapacity capacity;
  CycleMemory memory;
  InstrumentOptions options;
  std::unique_ptr<InstrumentMonitor> monitor = nullptr;  // or null
  struct {
    std::array<double, Chain::most_joints> ends{};
    std::array<MonitoredMotion::OfMesh, InstrumentCapacity::most_meshes> meshes{};
    std::array<MonitoredMotion::OfPair, most_pairs> pairs{};
  } monitored = {};
};

InstrumentConstraint::InstrumentConstraint(Instrument instrument, std::unique_ptr<Solver> solver,
                                           const InstrumentOptions& options,
                                           const InstrumentCapacity& capacity)
    : state_(std::make_unique<State>(std::move(instrument), std::move(solver), options, capacity)) {
  state_->prepare();
}

InstrumentConstraint::InstrumentConstraint(std::shared_ptr<const Mesh> mesh,
                                           std::shared_ptr<const SpatialIndex> index,
                                           Instrument instrument, std::unique_ptr<Solver> solver,
                                           const InstrumentOptions& options,
                                           const InstrumentCapacity& capacity)
    : InstrumentConstraint(std::move(instrument), std::move(solver), options, capacity) {
  add_mesh(std::move(mesh), std::move(index));
}

InstrumentConstraint::InstrumentConstraint(InstrumentConstraint&&) noexcept = default;
InstrumentConstraint& InstrumentConstraint::operator=(InstrumentConstraint&&) noexcept = default;
InstrumentConstraint::~InstrumentConstraint() = default;

InstrumentStep InstrumentConstraint::step(std::span<const double> q,
                                          const Twist& displacement) noexcept {
  return state_->step(q, is_valid_task(displacement), [&](const ChainState& chain) {
    return flange_task(chain, displacement, state_->options);
  });
}

InstrumentStep InstrumentConstraint::step(std::span<const double> q,
                                          std::span<const double> desired,
                                          std::span<const double> weights) noexcept {
  return state_->step(q, is_valid_task(desired, weights, q.size()),
                      [&](const ChainState&) { return joint_task(desired, weights); });
}

MotionProof InstrumentConstraint::prove(std::span<const double> q,
                                        std::span<const double> increment) noexcept {
  const RoundingToNearest rounding;
  const Status status =
      state_->renew_and_check(q, are_valid_positions(state_->memory, q, increment));
  if (!is_ok(status)) return {.status = status};
  MotionProof proof = prove_in_parts(state_->memory, state_->options, q, increment);
  proof.share = proof.fraction;
  return proof;
}

void InstrumentConstraint::forget() noexcept { state_->memory.forget(); }

const Instrument& InstrumentConstraint::instrument() const noexcept { return state_->instrument; }
std::size_t InstrumentConstraint::mesh_count() const noexcept {
  return state_->memory.meshes.size();
}
const Mesh& InstrumentConstraint::mesh(std::size_t number) const noexcept {
  return state_->memory.meshes[number].neighborhood->mesh();
}
const Pose& InstrumentConstraint::place_of(std::size_t number) const noexcept {
  return state_->memory.meshes[number].pose;
}
const InstrumentOptions& InstrumentConstraint::options() const noexcept { return state_->options; }

void InstrumentConstraint::set_options(const InstrumentOptions& options) {
  state_->memory.require_usable(options);
  state_->options = options;
}

std::size_t InstrumentConstraint::add_mesh(std::shared_ptr<const Mesh> mesh,
                                           std::shared_ptr<const SpatialIndex> index,
                                           double margin) {
  State& state = *state_;
  const std::size_t number = state.memory.meshes.size();
  if (number == InstrumentCapacity::most_meshes) {
    throw Error("an instrument has at most " + std::to_string(InstrumentCapacity::most_meshes) +
                " meshes");
  }
  if (!(margin >= 0.0)) {
    throw Error("margin: expected a length, or 0 for the margin of the options, got " +
                text_of(margin));
  }
  auto neighborhood =
      neighborhood_of(std::move(mesh), std::move(index), state.capacity, state.memory.budget);
  const bool is_closed = is_watertight(neighborhood->mesh());
  state.put({.neighborhood = std::move(neighborhood),
             .own_margin = margin,
             .is_watertight = is_closed,
             .motion = RelativeMotion(state.instrument, state.memory.trial_motion)},
            number);
  return number;
}

void InstrumentConstraint::follow(std::shared_ptr<const Mesh> moved,
                                  std::shared_ptr<const SpatialIndex> index, std::size_t number) {
  State& state = *state_;
  if (number >= state.memory.meshes.size()) {
    throw Error("there is no mesh number " + std::to_string(number));
  }
  const MeshMemory& old = state.memory.meshes[number];
  auto neighborhood =
      neighborhood_of(std::move(moved), std::move(index), state.capacity, state.memory.budget);
  const bool has_same_triangles =
      std::ranges::equal(neighborhood->mesh().triangles(), old.neighborhood->mesh().triangles());
  const bool is_closed =
      has_same_triangles ? old.is_watertight : is_watertight(neighborhood->mesh());
  state.put({.neighborhood = std::move(neighborhood),
             .own_margin = old.own_margin,
             .is_watertight = is_closed,
             .motion = RelativeMotion(state.instrument, state.memory.trial_motion),
             .pose = old.pose,
             .velocity = old.velocity,
             .has_refused_pose = old.has_refused_pose},
            number);
}

Status InstrumentConstraint::place(std::size_t number, const Pose& pose,
                                   const Twist& velocity) noexcept {
  const RoundingToNearest rounding;
  CycleMemory& memory = state_->memory;
  if (number >= memory.meshes.size()) return Status::invalid_input;
  MeshMemory& placed = memory.meshes[number];
  placed.has_refused_pose = !is_valid_placement(pose, velocity, memory.largest_length);
  if (placed.has_refused_pose) return Status::invalid_input;
  placed.pose = {pose.position, Eigen::Quaterniond(pose.rotation).normalized().matrix()};
  placed.velocity = velocity;
  memory.measure();
  return Status::free;
}

void InstrumentConstraint::set_guides(std::vector<Guide> guides) {
  state_->memory.set_guides(std::move(guides));
}

void InstrumentConstraint::set_monitor(std::unique_ptr<InstrumentMonitor> monitor) {
  state_->monitor = std::move(monitor);
}

double InstrumentConstraint::tolerance() const noexcept { return state_->memory.tolerance; }
std::size_t InstrumentConstraint::work_units() const noexcept {
  return state_->memory.budget.spent();
}

}  // namespace keepout
