// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/trial.h"

#include <new>

#include "bench/measure.h"
#include "bench/parts.h"
#include "bench/used_cores.h"
#include "keepout/activation/registry.h"
#include "keepout/error.h"
#include "keepout/factory/make_motion_constraint.h"
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
  double cores = 0.0;                            // kept busy meanwhile
  std::map<std::string, bool> searched_by = {};  // each rule that was asked whether it searches it
  std::string refusal = {};                      // why there is none
};

Trial::Trial(const Subject& subject, const TrialSettings& settings, MemoryTaken& memory,
             const StopSignal& stop)
    : subject_(subject),
      settings_(settings),
      memory_(memory),
      stop_(stop),
      loaded_(load(subject)),
      mesh_(std::move(loaded_.mesh)) {
  reference_index_ = std::make_unique<PdTree>(mesh_);
  Random random(settings_.seed);
  const MotionKind kind{.clearance = settings_.margin};
  motions_ = settings_.poses == Poses::contact
                 ? contact_motions(*mesh_, *reference_index_, settings_.queries, kind, random)
                 : unrelated_motions(*mesh_, settings_.queries, kind, random);
  work_ = std::make_unique<Workspace>(room);
}

Trial::~Trial() = default;

Activation& Trial::rule(const std::string& activation) {
  std::unique_ptr<Activation>& made = rules_[activation];
  if (!made) {
    made = make_activation(activation, mesh_);
    made->reserve(work_->candidates.capacity());
  }
  return *made;
}

Reference& Trial::reference(const RuleSetting& setting) {
  std::unique_ptr<Reference>& made = references_[{setting.activation, setting.radius}];
  if (!made) {
    made = std::make_unique<Reference>(mesh_, *reference_index_, rule(setting.activation), *work_,
                                       setting, motions_);
  }
  return *made;
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

bool Trial::is_searched_by(const std::string& activation) {
  const auto [known, is_new] = built_->searched_by.try_emplace(activation);
  if (is_new) known->second = rule(activation).searching(*built_->index) != nullptr;
  return known->second;
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

  const RuleSetting setting{combination.activation, combination.radius, settings_.margin};
  const double accuracy =
      combination.solver == "active_set"
          ? 0.0
          : entry_named(combination.solver, solver_backends(), "solver").accuracy;
  Reference& expected = reference(setting);
  if (!expected.fits()) {
    row.remark = "not timed: more than " + grouped(work_->candidates.capacity()) +
                 " triangles are in reach; ask for a smaller radius";
    return row;
  }
  MotionConstraint constraint = make_motion_constraint(mesh_, built.index,
                                                       {.activation = combination.activation,
                                                        .solver = combination.solver,
                                                        .radius = options_of(setting).radius,
                                                        .margin = options_of(setting).margin,
                                                        .inside = Inside::taken_as_is,
                                                        .capacity = room});
  app::measure({*built.index, constraint, is_searched_by(combination.activation), accuracy},
               motions_, expected, settings_.seconds, stop_, row);
  return row;
}

}  // namespace keepout::app
