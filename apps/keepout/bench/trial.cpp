// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/trial.h"

#include <new>

#include "bench/measure.h"
#include "bench/parts.h"
#include "bench/used_cores.h"
#include "keepout/error.h"
#include "keepout/fixtures/motions.h"
#include "keepout/index/pd_tree.h"
#include "machine.h"
#include "number_text.h"

namespace keepout::app {
namespace {

/// Room for every step that shall be timed.
constexpr Capacity room{
    .triangles = std::size_t{1} << 18, .planes = std::size_t{1} << 16, .variables = 3};

}  // namespace

/// The index at hand, and what it took.
struct Trial::Built {
  std::string name;
  std::shared_ptr<const SpatialIndex> index = nullptr;
  double seconds = 0.0;
  double cores = 0.0;        // kept busy meanwhile
  std::string refusal = {};  // why there is none
};

Trial::Trial(const Subject& subject, const TrialSettings& settings, MemoryTaken& memory,
             const StopSignal& stop)
    : subject_(subject),
      settings_(settings),
      memory_(memory),
      stop_(stop),
      loaded_(load(subject)),
      mesh_(std::move(loaded_.mesh)) {
  reference_index_ = std::make_shared<const PdTree>(mesh_);
  Random random(settings_.seed);
  const MotionKind kind{.clearance = settings_.margin};
  motions_ = settings_.poses == Poses::contact
                 ? contact_motions(*mesh_, *reference_index_, settings_.queries, kind, random)
                 : unrelated_motions(*mesh_, settings_.queries, kind, random);
}

Trial::~Trial() = default;

ReferenceGuard& Trial::guard(const MotionConstraintSettings& settings) {
  const auto known = guards_.find(settings.activation);
  if (known != guards_.end()) return known->second;
  return guards_
      .emplace(settings.activation, make_reference_guard(mesh_, reference_index_, settings))
      .first->second;
}

Reference& Trial::reference(const MotionConstraintSettings& settings) {
  return references_
      .try_emplace({settings.activation, settings.radius}, guard(settings), mesh_, settings,
                   motions_)
      .first->second;
}

const Trial::Built& Trial::build(const std::string& index) {
  if (built_ && built_->name == index) return *built_;
  built_.reset();  // two large ones need not fit
  built_ = std::make_unique<Built>(Built{.name = index});
  const IndexBackend& backend = entry_named(index, indices(), "index", absent_indices());
  const auto count = static_cast<double>(mesh_->triangle_count());
  constexpr double while_building = 1.5;  // some hold more then
  if (const auto taken = memory_.find(index); taken != memory_.end()) {
    const double needed = while_building * taken->second * count;
    const auto available = static_cast<double>(available_memory());
    if (needed > available) {
      built_->refusal = "not built: needs up to " + rounded(1e-9 * needed, 2) + " GB, and " +
                        rounded(1e-9 * available, 2) + " GB are free";
      return *built_;
    }
  }
  try {
    const UsedCores used;
    built_->index = backend.make(mesh_);
    built_->seconds = used.seconds();
    built_->cores = used.own();
    memory_[index] = static_cast<double>(built_->index->memory()) / count;
  } catch (const Error& error) {
    built_->refusal = std::string("not built: ") + error.what();
  } catch (const std::bad_alloc&) {
    built_->refusal = "not built: out of memory";
  }
  return *built_;
}

BenchmarkRow Trial::measure(const Combination& combination) {
  BenchmarkRow row{.mesh = label_of(subject_),
                   .triangles = mesh_->triangle_count(),
                   .vertices = mesh_->vertex_count(),
                   .load_s = loaded_.seconds,
                   .load_cores = loaded_.cores,
                   .radius = combination.radius,
                   .index = combination.index,
                   .activation = combination.activation,
                   .solver = combination.solver};
  const Built& built = build(combination.index);
  row.remark = built.refusal;
  if (!built.index) return row;
  row.build_s = built.seconds;
  row.build_cores = built.cores;
  row.bytes_per_triangle =
      static_cast<double>(built.index->memory()) / static_cast<double>(mesh_->triangle_count());

  // The certified rule looks only where the motion leads, and the paper's take the tip as it is.
  const MotionConstraintSettings settings{
      .activation = combination.activation,
      .solver = combination.solver,
      .radius = combination.radius.value_or(5.0),
      .margin = combination.activation == "certified" ? settings_.margin : 0.0,
      .inside = Inside::taken_as_is,
      .capacity = room};
  Reference& expected = reference(settings);
  if (!expected.fits()) {
    row.remark = "not timed: more than " + grouped(expected.candidates.capacity()) +
                 " triangles are in reach; ask for a smaller radius";
    return row;
  }
  const double accuracy =
      combination.solver == "active_set"
          ? 0.0
          : entry_named(combination.solver, solver_backends(), "solver").accuracy;
  MotionConstraint constraint = make_motion_constraint(mesh_, built.index, settings);
  const bool searches = guard(settings).rule->searching(*built.index) != nullptr;
  app::measure({*built.index, constraint, searches, accuracy}, motions_, expected,
               settings_.seconds, stop_, row);
  return row;
}

}  // namespace keepout::app
