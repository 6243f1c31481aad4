// SPDX-License-Identifier: BSD-3-Clause
//
// The proof of a long motion for planners, in parts.
#include "joint_cycle.h"

namespace keepout {

MotionProof prove_in_parts(CycleMemory& memory, const InstrumentOptions& options,
                           std::span<const double> q, std::span<const double> increment) noexcept {
  const CycleMemory::Certified certified = memory.certified();
  InstrumentOptions unslowed = options;
  unslowed.slowing_within = 0.0;
  constexpr double least_span = 1.0 / 64.0;
  MotionProof proof{.status = Status::free};
  double span = 1.0;  // of a part of the motion
  while (proof.fraction < 1.0) {
    JointVector from{};
    JointVector motion{};
    for (std::size_t k = 0; k < q.size(); ++k) {
      from[k] = q[k] + proof.fraction * increment[k];
      motion[k] = span * increment[k];
    }
    memory.budget.renew();
    memory.forget_motion();
    memory.forget_certified();
    const MotionProof part =
        JointCycle(memory, unslowed, {from.data(), q.size()}, JointCycle::MeshMotion::ignored)
            .prove(motion);
    const bool was_too_much =
        part.status == Status::over_capacity || part.status == Status::out_of_budget;
    if (was_too_much && span > least_span) {
      span *= 0.5;
      continue;
    }
    // A later part that begins too close would be certified for less than the first one.
    if (proof.fraction > 0.0 && part.status == Status::recovering &&
        proof.status != Status::recovering) {
      break;
    }
    if (proof.fraction == 0.0) proof.distance = part.distance;
    if (proof.fraction == 0.0 || !is_ok(part.status)) proof.status = part.status;
    proof.fraction += span * part.fraction;
    if (part.fraction < 1.0 || part.status != Status::free) break;
  }
  memory.forget_motion();
  memory.set_certified(certified);
  if (proof.status == Status::free && proof.fraction < 1.0) proof.status = Status::limited;
  return proof;
}

}  // namespace keepout
