// SPDX-License-Identifier: BSD-3-Clause
//
// The report of a joint cycle: why a motion is not the commanded one, by limits and guides.
#include "joint_cycle.h"

namespace keepout {

std::string_view InstrumentStep::reason() const noexcept {
  if (status == Status::free && limits.has(Limit::joints_outside)) {
    return "the motion is the commanded one, but a joint starts outside its position limits, where "
           "it may stay or return: check q";
  }
  return keepout::reason(status, Subject::instrument);
}

std::string_view MotionProof::reason() const noexcept {
  if (status == Status::free) return "the whole motion is proved";
  if (status == Status::limited) return "only `fraction` of the motion is proved";
  if (status == Status::recovering) {
    return "a body is nearer than the margin at the start; on `fraction` of the motion no body "
           "comes closer by more than the band";
  }
  return keepout::reason(status, Subject::instrument);
}

/// Notes that a guide ended a search.
void JointCycle::note_guide(std::size_t guide) noexcept {
  stopping_limits_.add(Limit::guide);
  stopping_guides_.set(guide);
}

/// Notes the kinds of constraints for which the last trial of a search was not proved. If the rows
/// contradict each other, notes the kinds of the rows.
void JointCycle::note_failure() noexcept {
  if (search_status_ == Status::ill_posed) return;
  if (search_status_ == Status::infeasible) {
    for (const Row& row : rows_.view()) {
      if (is_guide(row.owner)) {
        note_guide(guide_of(row.owner));
      } else {
        stopping_limits_.add(Limit::mesh);
      }
    }
    return;
  }
  // If the budget ended, the guide's obstacle marks only the end of the proof.
  if (judgement_.guide.knot < PointMotion::last_knot && !is_spent())
    note_guide(judgement_.guide.guide);
  for (const Certificate::Obstacle& obstacle : memory_.obstacles) {
    if (obstacle.triangle != nullptr) stopping_limits_.add(Limit::mesh);
  }
}

/// Notes the kind of limit of a search or a proof that the budget or the capacity ended.
void JointCycle::note_end(Status status) noexcept {
  if (status == Status::over_capacity) stopping_limits_.add(Limit::capacity);
  if (status == Status::out_of_budget) stopping_limits_.add(Limit::budget);
}

/// Reports the guides that limit the motion, and those that were relaxed. `is_cut`: the motion is
/// only a part of the commanded one, or there is no motion.
void JointCycle::report_guides(const Trial& best, bool is_cut, InstrumentStep& result) noexcept {
  result.relaxation = best.relaxation;
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    GuideState& state = guides_.states()[g];
    state.limits = best.guides[g] || (is_cut && stopping_guides_[g]);
    state.relaxed =
        (best.relaxation != Relaxation::none && state.excess > 0.0) || guides_.is_dropped(g);
    if (guides_.is_dropped(g) && result.relaxation == Relaxation::none) {
      result.relaxation = Relaxation::guides;
    }
  }
}

/// Reports the limits: the causes why the motion is not the commanded one. `is_cut`: as above.
void JointCycle::report_limits(const Trial& best, bool is_cut, InstrumentStep& result) noexcept {
  const Status status = result.status;
  if (status == Status::free) return;
  Limits& limits = result.limits;
  if (status == Status::touching || status == Status::inside) limits.add(Limit::mesh);
  note_end(status);
  limits.add(best.limits);
  if (!is_cut) return;
  limits.add(stopping_limits_);
  if (is_ok(status)) limits.add(Limit::truncated);
}

}  // namespace keepout
