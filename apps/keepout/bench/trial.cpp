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

MotionConstraint& Trial::guard(const MotionConstraintSettings& settings) {
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

void Trial::build(const std::string& index) {
  if (row_.index == index) return;
  index_.reset();  // two large ones need not fit
  row_ = {.mesh = label_of(subject_),
          .triangles = mesh_->triangle_count(),
          .vertices = mesh_->vertex_count(),
          .load_s = loaded_.seconds,
          .load_cores = loaded_.cores,
          .index = index};
  const IndexBackend& backend = entry_named(index, indices(), "index", absent_indices());
  const auto count = static_cast<double>(mesh_->triangle_count());
  constexpr double while_building = 1.5;  // some hold more then
  if (const auto taken = memory_.find(index); taken != memory_.end()) {
    const double needed = while_building * taken->second * count;
    const auto available = static_cast<double>(available_memory());
    if (needed > available) {
      row_.remark = "not built: needs up to " + rounded(1e-9 * needed, 2) + " GB, and " +
                    rounded(1e-9 * available, 2) + " GB are free";
      return;
    }
  }
  try {
    const UsedCores used;
    index_ = backend.make(mesh_);
    row_.build_s = used.seconds();
    row_.build_cores = used.own();
    row_.bytes_per_triangle = memory_[index] = static_cast<double>(index_->memory()) / count;
  } catch (const Error& error) {
    row_.remark = std::string("not built: ") + error.what();
  } catch (const std::bad_alloc&) {
    row_.remark = "not built: out of memory";
  }
}

BenchmarkRow Trial::measure(const Combination& combination) {
  build(combination.index);
  BenchmarkRow row = row_;
  row.radius = combination.radius;
  row.activation = combination.activation;
  row.solver = combination.solver;
  if (!index_) return row;

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
  MotionConstraint constraint = make_motion_constraint(mesh_, index_, settings);
  app::measure({constraint, accuracy}, motions_, expected, settings_.seconds, stop_, row);
  return row;
}

}  // namespace keepout::app
