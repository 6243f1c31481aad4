// SPDX-License-Identifier: BSD-3-Clause
//
// The report of a joint cycle: the limits and guides that kept a motion from being the commanded
// one.
#include "joint_cycle.h"

namespace keepout {
namespace {

void add_all(Limits& limits, const Limits& others) noexcept {
  for (std::size_t i = 0; i < limit_count; ++i) {
    if (others.has(static_cast<Limit>(i))) limits.add(static_cast<Limit>(i));
  }
}

}  // namespace

/// Notes the kinds of constraints that the last trial of an attempt could not be proved for. If the
/// rows contradict each other, notes the kinds of the rows.
void JointCycle::note_failure() noexcept {
  if (trouble_ == Status::infeasible) {
    for (const ContactRow& row : memory_.rows) {
      stopped_.add(row.owner < most_pairs ? Limit::mesh : Limit::guide);
    }
    return;
  }
  // A proof that the budget ended says nothing about its subject.
  if (kept_by_guides_ < PointMotion::cells && !is_worn_out()) stopped_.add(Limit::guide);
  for (const PairMemory& pair : memory_.pairs) {
    if (pair.failure.triangle != nullptr) stopped_.add(Limit::mesh);
  }
}

/// Reports the limits that kept the motion from being the commanded one.
void JointCycle::report_limits(const Trial& best, InstrumentStep& result) noexcept {
  Limits& limits = result.limits;
  if (result.status == Status::touching || result.status == Status::inside) limits.add(Limit::mesh);
  if (trouble_ == Status::over_capacity) limits.add(Limit::capacity);
  if (trouble_ == Status::out_of_budget) limits.add(Limit::budget);
  add_all(limits, best.held);
  const bool is_cut = is_shortened_ || best.share < 1.0;
  if (!is_cut) return;
  add_all(limits, stopped_);
  if (is_ok(result.status)) limits.add(Limit::truncated);
}

/// Reports which guides limit the motion, and which were relaxed.
void JointCycle::report_guides(const Trial& best, InstrumentStep& result) noexcept {
  result.relaxation = best.relaxation;
  for (const WarmRow& warm : memory_.warm) {
    if (warm.owner < most_pairs) continue;
    memory_.guide_states[warm.owner - most_pairs].limits = true;
  }
  const bool is_cut = !is_ok(result.status) || is_shortened_ || best.share < 1.0;
  for (std::size_t g = 0; g < memory_.guides.size(); ++g) {
    GuideState& state = memory_.guide_states[g];
    state.limits = state.limits || (is_cut && has_failed_[g]);
    state.relaxed =
        (best.relaxation != Relaxation::none && state.excess > 0.0) || guides_.is_dropped(g);
    if (guides_.is_dropped(g) && result.relaxation == Relaxation::none) {
      result.relaxation = Relaxation::guides;
    }
  }
}

}  // namespace keepout
