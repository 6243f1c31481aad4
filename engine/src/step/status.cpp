// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/status.h"

namespace keepout {

std::string_view name(Status status) noexcept {
  switch (status) {
    case Status::free:
      return "free";
    case Status::limited:
      return "limited";
    case Status::recovering:
      return "recovering";
    case Status::fallback:
      return "fallback";
    case Status::infeasible:
      return "infeasible";
    case Status::ill_posed:
      return "ill_posed";
    case Status::invalid_input:
      return "invalid_input";
    case Status::beyond_reach:
      return "beyond_reach";
    case Status::over_capacity:
      return "over_capacity";
    case Status::unsolved:
      return "unsolved";
    case Status::inside:
      return "inside";
    case Status::touching:
      return "touching";
    case Status::margin_too_small:
      return "margin_too_small";
  }
  return "unknown";
}

std::string_view reason(Status status) noexcept {
  switch (status) {
    case Status::free:
      return "nothing holds the motion back";
    case Status::limited:
      return "planes of nearby triangles hold the motion back";
    case Status::recovering:
      return "the tip was closer than the margin, or inside: the motion leads it out";
    case Status::fallback:
      return "the best motion could not be proven within the budget of work: this is a shorter one "
             "that was";
    case Status::infeasible:
      return "no motion satisfies all planes: the tip is closer than the margin on several sides, "
             "or the joints cannot move it away; retreat, or lower the margin";
    case Status::ill_posed:
      return "the Jacobian lacks full column rank, or all but, as it does with more than three "
             "joints: set damping above 0";
    case Status::invalid_input:
      return "a number is missing, not finite, beyond 1e30, or so far from the origin that the "
             "step is lost in its digits, or a Jacobian has other than 3 rows: check the tip, the "
             "increment and the Jacobian";
    case Status::beyond_reach:
      return "the motion is longer than the radius of the motion sphere: ask for less in a cycle, "
             "or declare a larger radius; are motion, radius and mesh in one unit, as mm?";
    case Status::over_capacity:
      return "more triangles, planes or joints than room was made for: lower the radius, or raise "
             "the capacity (of joints: Capacity::variables, max_joints in Python); or is the mesh "
             "in "
             "metres, so that a radius in mm holds all of it?";
    case Status::unsolved:
      return "the solver gave up within its budget of work, or its answer did not satisfy the "
             "planes";
    case Status::inside:
      return "the tip is on the forbidden side: lead it out by steps without a Jacobian and rows, "
             "or by hand; if it is outside, the mesh is wound inside out";
    case Status::touching:
      return "the tip touches the surface, and which side is free cannot be told: move it off by "
             "hand";
    case Status::margin_too_small:
      return "the margin is lost in the rounding of lengths this large: raise the margin or the "
             "tool radius, or move the origin closer; or is the mesh in micrometres?";
  }
  return "unknown status";
}

Status status_of(SolveStatus failure) noexcept {
  switch (failure) {
    case SolveStatus::infeasible:
      return Status::infeasible;
    case SolveStatus::ill_posed:
      return Status::ill_posed;
    case SolveStatus::invalid_input:
      return Status::invalid_input;
    case SolveStatus::over_capacity:
      return Status::over_capacity;
    case SolveStatus::optimal:
    case SolveStatus::iteration_limit:
      break;
  }
  return Status::unsolved;
}

}  // namespace keepout
