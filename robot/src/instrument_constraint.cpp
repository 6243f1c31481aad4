// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/instrument_constraint.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "joint_cycle.h"
#include "keepout/activation/tolerances.h"
#include "keepout/error.h"
#include "keepout/mesh/doctor.h"
#include "keepout/step/options.h"

namespace keepout {
namespace {

constexpr double rotation_digits = 1e-6;  // that a rotation is to have
constexpr double fastest_turn = 1.0;      // of a mesh in a cycle [rad]

bool are_numbers(std::span<const double> values) noexcept {
  return std::all_of(values.begin(), values.end(),
                     [](double x) { return std::abs(x) <= largest_number; });  // false for NaN
}

std::unique_ptr<Neighborhood> neighborhood_of(std::shared_ptr<const Mesh> mesh,
                                              std::shared_ptr<const SpatialIndex> index,
                                              const InstrumentCapacity& capacity, Budget& budget) {
  if (!mesh || !index) throw Error("an instrument constraint needs a mesh and an index of it");
  if (capacity.triangles == 0) {
    throw Error("the capacity must be of at least one triangle");
  }
  return std::make_unique<Neighborhood>(std::move(mesh), std::move(index), capacity.triangles,
                                        budget);
}

Instrument& required(Instrument& instrument, const Solver* solver,
                     const InstrumentCapacity& capacity) {
  if (solver == nullptr) throw Error("an instrument constraint needs a solver");
  if (capacity.planes == 0 || capacity.planes > (1u << 16)) {
    throw Error("the capacity must be of at least one plane, and at most 65536");
  }
  return instrument;
}

}  // namespace

struct InstrumentConstraint::State {
  State(Instrument its, std::unique_ptr<Solver> its_solver, const InstrumentCapacity& its_capacity)
      : instrument(std::move(required(its, its_solver.get(), its_capacity))),
        solver(std::move(its_solver)),
        memory(instrument, *solver, its_capacity),
        capacity(its_capacity) {}

  /// Puts a mesh where there is one of that number, or to the others; and takes that back where
  /// it cannot be used.
  void put(MeshMemory mesh, std::size_t number, const InstrumentOptions& its_options) {
    const std::vector<MeshMemory>::iterator at =
        memory.bodies.meshes.begin() + static_cast<std::ptrdiff_t>(number);
    const bool is_new = at == memory.bodies.meshes.end();
    if (is_new) {
      memory.bodies.meshes.push_back(std::move(mesh));
    } else {
      std::swap(*at, mesh);
    }
    try {
      memory.prepare();
      memory.require_usable(its_options);
    } catch (...) {
      if (is_new) {
        memory.bodies.meshes.pop_back();
      } else {
        std::swap(memory.bodies.meshes[number], mesh);
      }
      memory.prepare();
      throw;
    }
    std::size_t looks = 0;
    for (const MeshMemory& each : memory.bodies.meshes) {
      const SpatialIndex& index = each.near->index();
      looks = std::max(looks, Capacity::looks_or_default(capacity.looks, index));
    }
    memory.budget = Budget(looks);
  }

  InstrumentStep step(const JointTask& task, std::span<const double> q) noexcept {
    InstrumentStep result;
    JointCycle(memory, options, q, JointCycle::Meshes::moving).run(task, result);
    return result;
  }

  /// Before anything else: why there can be no step.
  Status check(std::span<const double> q) noexcept {
    memory.budget.renew();
    for (const MeshMemory& mesh : memory.bodies.meshes) {
      const bool is_too_fast =
          !(options.period * mesh.velocity.angular.norm() <= fastest_turn) ||
          !(options.period * mesh.velocity.linear.norm() <= memory.largest_position);
      if (mesh.is_misplaced || is_too_fast) return Status::invalid_input;
      if (!mesh.near->is_current()) return Status::mesh_changed;
    }
    // Meshes move, so rounding may have outgrown the margin since it was set.
    if (memory.is_lost_in_rounding(options)) return Status::margin_too_small;
    const auto n = static_cast<std::size_t>(instrument.chain().size());
    return q.size() == n && are_positions(q) ? Status::free : Status::invalid_input;
  }

  /// Whether the joints can be there, moved by that (n) or by nothing.
  bool are_positions(std::span<const double> q, std::span<const double> moved = {}) const noexcept {
    for (std::size_t k = 0; k < q.size(); ++k) {
      const double there = moved.empty() ? q[k] : q[k] + moved[k];
      if (!(std::abs(there) <= memory.farthest(static_cast<int>(k) + 1))) return false;  // or NaN
    }
    return true;
  }

  /// A cycle has passed, whatever came of it: what moves is where it leads, and where nothing was
  /// proven nothing is kept.
  void pass_time(InstrumentStep& result) noexcept {
    if (!memory.is_moving()) return;
    if (!result.ok()) result.level = 0.0;
    for (MeshMemory& mesh : memory.bodies.meshes) {
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
  CycleMemory memory;
  InstrumentCapacity capacity;
  InstrumentOptions options;
};

InstrumentConstraint::InstrumentConstraint(std::shared_ptr<const Mesh> mesh,
                                           std::shared_ptr<const SpatialIndex> index,
                                           Instrument instrument, std::unique_ptr<Solver> solver,
                                           const InstrumentOptions& options,
                                           const InstrumentCapacity& capacity)
    : state_(std::make_unique<State>(std::move(instrument), std::move(solver), capacity)) {
  state_->options = options;
  add_mesh(std::move(mesh), std::move(index));
}

InstrumentConstraint::InstrumentConstraint(InstrumentConstraint&&) noexcept = default;
InstrumentConstraint& InstrumentConstraint::operator=(InstrumentConstraint&&) noexcept = default;
InstrumentConstraint::~InstrumentConstraint() = default;

InstrumentStep InstrumentConstraint::step(std::span<const double> q,
                                          const Twist& desired) noexcept {
  Status status = state_->check(q);
  const bool is_number =
      are_numbers({desired.linear.data(), 3}) && are_numbers({desired.angular.data(), 3});
  if (is_ok(status) && !is_number) status = Status::invalid_input;
  InstrumentStep result{.status = status};
  if (is_ok(status)) {
    ChainState chain;
    state_->instrument.chain().forward_kinematics(q, chain);
    result = state_->step(flange_task(chain, desired, state_->options), q);
  }
  state_->pass_time(result);
  return result;
}

InstrumentStep InstrumentConstraint::step(std::span<const double> q,
                                          std::span<const double> desired,
                                          std::span<const double> weights) noexcept {
  Status status = state_->check(q);
  const bool is_weighed =
      weights.empty() || (weights.size() == q.size() && are_numbers(weights) &&
                          *std::min_element(weights.begin(), weights.end()) > 0);
  if (is_ok(status) && !(desired.size() == q.size() && are_numbers(desired) && is_weighed)) {
    status = Status::invalid_input;
  }
  InstrumentStep result{.status = status};
  if (is_ok(status)) result = state_->step(joint_task(desired, weights), q);
  state_->pass_time(result);
  return result;
}

MotionProof InstrumentConstraint::prove(std::span<const double> q,
                                        std::span<const double> increment) noexcept {
  Status status = state_->check(q);
  if (is_ok(status) && !(increment.size() == q.size() && state_->are_positions(q, increment))) {
    status = Status::invalid_input;
  }
  if (!is_ok(status)) return {.status = status};
  return prove_in_parts(state_->memory, state_->options, q, increment);
}

void InstrumentConstraint::forget() noexcept { state_->memory.forget(); }

const Instrument& InstrumentConstraint::instrument() const noexcept { return state_->instrument; }
std::size_t InstrumentConstraint::mesh_count() const noexcept {
  return state_->memory.bodies.meshes.size();
}
const Mesh& InstrumentConstraint::mesh(std::size_t number) const noexcept {
  return state_->memory.bodies.meshes[number].near->mesh();
}
const Pose& InstrumentConstraint::place_of(std::size_t mesh) const noexcept {
  return state_->memory.bodies.meshes[mesh].pose;
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
  const std::size_t number = state.memory.bodies.meshes.size();
  if (number == most_meshes) {
    throw Error("an instrument is kept out of at most " + std::to_string(most_meshes) + " meshes");
  }
  if (!(margin >= 0.0)) throw Error("the margin of a mesh must not be below zero");
  auto near =
      neighborhood_of(std::move(mesh), std::move(index), state.capacity, state.memory.budget);
  const bool is_closed = is_watertight(near->mesh());
  state.put({.near = std::move(near),
             .own_margin = margin,
             .is_watertight = is_closed,
             .motion = RelativeMotion(state.instrument, state.memory.motion)},
            number, state.options);
  return number;
}

void InstrumentConstraint::follow(std::shared_ptr<const Mesh> moved,
                                  std::shared_ptr<const SpatialIndex> index, std::size_t number) {
  State& state = *state_;
  if (number >= state.memory.bodies.meshes.size()) {
    throw Error("there is no mesh of number " + std::to_string(number));
  }
  const MeshMemory& old = state.memory.bodies.meshes[number];
  auto near =
      neighborhood_of(std::move(moved), std::move(index), state.capacity, state.memory.budget);
  const bool has_same_triangles =
      std::ranges::equal(near->mesh().triangles(), old.near->mesh().triangles());
  const bool is_closed = has_same_triangles ? old.is_watertight : is_watertight(near->mesh());
  state.put({.near = std::move(near),
             .own_margin = old.own_margin,
             .is_watertight = is_closed,
             .motion = RelativeMotion(state.instrument, state.memory.motion),
             .pose = old.pose,
             .velocity = old.velocity,
             .is_misplaced = old.is_misplaced},
            number, state.options);
}

Status InstrumentConstraint::place(std::size_t mesh, const Pose& pose,
                                   const Twist& velocity) noexcept {
  CycleMemory& memory = state_->memory;
  if (mesh >= memory.bodies.meshes.size()) return Status::invalid_input;
  const auto is_within = [](const auto& numbers, double most) {
    return (numbers.array().abs() <= most).all();  // false for NaN
  };
  const Mat3 off = pose.rotation.transpose() * pose.rotation - Mat3::Identity();
  MeshMemory& placed = memory.bodies.meshes[mesh];
  placed.is_misplaced = !is_within(pose.position, memory.largest_position) ||
                        !is_within(off, rotation_digits) || !(pose.rotation.determinant() > 0.0) ||
                        !is_within(velocity.linear, largest_number) ||
                        !is_within(velocity.angular, largest_number);
  if (placed.is_misplaced) return Status::invalid_input;
  placed.pose = {pose.position, Eigen::Quaterniond(pose.rotation).normalized().matrix()};
  placed.velocity = velocity;
  memory.measure();
  return Status::free;
}

void InstrumentConstraint::set_guides(std::vector<Guide> guides) {
  if (guides.size() > Guide::most) {
    throw Error("an instrument has at most " + std::to_string(Guide::most) + " guides, not " +
                std::to_string(guides.size()));
  }
  for (const Guide& guide : guides) {
    if (!(guide.band() > needed_band * tolerance_of(guide, state_->memory.tolerance))) {
      throw Error("the band of guide '" + guide.name() +
                  "' is lost in the rounding of an instrument and a mesh of this size");
    }
    if (guide.link() == 0) {
      throw Error("guide '" + guide.name() +
                  "' is on link 0, the base, which no joint moves: give it a link of the chain");
    }
    if (guide.link() <= state_->instrument.chain().size()) continue;
    throw Error("guide '" + guide.name() + "' is on link " + std::to_string(guide.link()) +
                "; there are links 0 to " + std::to_string(state_->instrument.chain().size()));
  }
  GuideMemories& memory = state_->memory.guides;
  memory.guides.clear();
  for (Guide& guide : guides) {
    memory.guides.push_back({std::move(guide), -std::numeric_limits<double>::infinity()});
  }
  memory.states.assign(memory.guides.size(), {});
  state_->memory.forget_motion();
}

double InstrumentConstraint::tolerance() const noexcept { return state_->memory.tolerance; }
std::size_t InstrumentConstraint::looks() const noexcept { return state_->memory.budget.spent(); }

}  // namespace keepout
