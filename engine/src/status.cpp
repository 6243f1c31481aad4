// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/status.h"

#include <array>
#include <cstddef>

#include "keepout/step/solver.h"

namespace keepout {
namespace {

/// The name of a status and its reason for each Subject, in their order.
struct Outcome {
  std::string_view name;
  std::array<std::string_view, 3> reasons;
};

constexpr std::string_view never = "a status that this kind of result never has";

// In the order of the enumeration.
constexpr std::array outcomes{
    Outcome{
        "free",
        {"the motion is the one asked for", "the motion is the one asked for",
         "every motion within the planes and the radius maintains the required clearance, or the "
         "distance of the tip if that is less"}},
    Outcome{"limited",
            {"constraints limit the motion to the nearest one that they allow: `limits` names them",
             "constraints limit the motion to the nearest one that they allow: `limits` names them",
             never}},
    Outcome{
        "recovering",
        {"the tip was nearer than the margin, inside, or outside a guide's region: the motion "
         "moves it back",
         "a body was nearer than the margin, or a guided part was outside its region: the motion "
         "moves it back",
         never}},
    Outcome{"truncated",
            {"only a shorter motion could be proved: `limits` names what stops the rest",
             "only a shorter motion could be proved: `limits` names what stops the rest", never}},
    Outcome{"degraded",
            {never,
             "a mesh approaches faster than the instrument can retreat: the motion is proved to "
             "maintain less than the certified clearance, see `clearance_fraction`; slow the mesh "
             "down, or move the instrument away",
             never}},
    Outcome{"infeasible",
            {"no motion satisfies all planes and rows: the tip is nearer than the margin on "
             "several sides, or the joints cannot move it away; retreat, or lower `margin`",
             "no joint increment satisfies all rows: bodies are nearer than the margin on several "
             "sides, or the joints cannot move them away; retreat, or lower `margin`",
             never}},
    Outcome{"ill_posed",
            {"the Jacobian lacks full column rank, or almost, as it does with more than three "
             "joints: set `damping` above 0",
             "the task leaves a joint increment undetermined: set `damping` above 0", never}},
    Outcome{"invalid_input",
            {"a number is missing, not finite, beyond 1e15 (of a Jacobian or rows 1e30), or so "
             "far from the origin that rounding hides the step, or a Jacobian has other than 3 "
             "rows: check the tip, the increment and the Jacobian",
             "a joint position, the desired motion or a weight is missing, not finite or out of "
             "range, or a mesh has no valid pose or moves or turns too far in a cycle: check q, "
             "the desired motion, and the last place()",
             "the tip or the radius is not finite, negative or beyond 1e15"}},
    Outcome{"beyond_reach",
            {"the motion is longer than the radius of the motion sphere: ask for less in a cycle, "
             "or raise `radius`; are motion, radius and mesh in one unit, such as mm?",
             never, never}},
    Outcome{"over_capacity",
            {"more triangles, planes, rows or joints than the capacity holds: lower `radius`, or "
             "raise Capacity::triangles, planes, extra_rows or variables (max_triangles, "
             "max_planes, max_rows, max_joints in Python); or is the mesh in meters, so that a "
             "radius in mm holds all of it?",
             "more triangles near a body, or more planes, than the capacity holds: raise "
             "InstrumentCapacity::triangles or planes (max_triangles, max_planes in Python), or "
             "simplify the mesh",
             "more triangles or planes than the capacity holds: lower the radius of the polytope, "
             "or raise Capacity::triangles or planes (max_triangles, max_planes in Python)"}},
    Outcome{"unsolved",
            {"the search ended without a motion that could be proved: ask for a shorter motion, or "
             "one in another direction",
             "the search ended without a motion that could be proved: ask for a shorter motion, or "
             "one in another direction",
             never}},
    Outcome{"inside",
            {"the tip is on the forbidden side, deeper than `deepest`, or a Jacobian, rows, a "
             "guide or too small a `recovery` prevent its escape: move it out by hand, or "
             "by steps without them; if it is outside, the mesh is wound inside out",
             "a body is on the forbidden side: move it out by hand; if it is outside, the mesh is "
             "wound inside out",
             "the tip is on the forbidden side: a step moves it out; if it is outside, the mesh is "
             "wound inside out"}},
    Outcome{"touching",
            {"the tip touches the surface, and its free side is unknown: move it off by hand",
             "the core of a body touches the surface, and its free side is unknown: move it off by "
             "hand",
             "the tip is on the surface, to within rounding, and no side of it is certain: go back "
             "to the last free place"}},
    Outcome{"margin_too_small",
            {"the margin is lost in the rounding of lengths this large: raise `margin` or "
             "`tool_radius`, or move the origin closer; or is the mesh in micrometers?",
             "the margin or the band is lost in the rounding of lengths this large: place() put a "
             "mesh too far from the origin; move the origin closer, or raise `margin` and `band`",
             never}},
    Outcome{"mesh_changed",
            {"the index was refit to another mesh: call follow(), and check where the tip is now",
             "the index was refit to another mesh: call follow(), and check where the bodies are "
             "now",
             "the index was refit to another mesh: call follow()"}},
    Outcome{"out_of_budget",
            {"the work budget of the cycle ended before a motion was proved: ask for a shorter "
             "motion, simplify the mesh, or raise Capacity::work_units (max_work_units in Python)",
             "the work budget of the cycle ended before a motion was proved: ask for a shorter "
             "motion, simplify the mesh, or raise InstrumentCapacity::work_units (max_work_units "
             "in Python)",
             "the work budget ended before the polytope was complete: lower the radius of the "
             "polytope, or raise Capacity::work_units (max_work_units in Python)"}},
    Outcome{"unsupported",
            {never, never,
             "planes around the tip would not guard the rest of a tool, nor keep to a guide: use a "
             "rule that guards a tip, and set no guides"}},
    Outcome{"unconfirmed",
            {"the monitor did not confirm the clearance of the motion: stop, and report it; if the "
             "motion is right, the work of the monitor ended",
             "the monitor did not confirm the clearance of the motion: stop, and report it; if the "
             "motion is right, the work of the monitor ended",
             never}},
};
static_assert(outcomes.size() == status_count);

// In the order of the enumeration.
constexpr std::array<std::string_view, limit_count> limit_names{
    "mesh",          "guide",  "joint_position", "joint_velocity", "rows",           "radius",
    "linearization", "budget", "capacity",       "truncated",      "joints_outside", "singularity"};

}  // namespace

std::string_view name(Status status) noexcept {
  const auto place = static_cast<std::size_t>(status);
  return place < outcomes.size() ? outcomes[place].name : "unknown";
}

std::string_view reason(Status status, Subject subject) noexcept {
  const auto place = static_cast<std::size_t>(status);
  const auto column = static_cast<std::size_t>(subject);
  if (place >= outcomes.size() || column >= outcomes[place].reasons.size()) return "unknown status";
  return outcomes[place].reasons[column];
}

std::string_view name(Limit limit) noexcept {
  const auto place = static_cast<std::size_t>(limit);
  return place < limit_names.size() ? limit_names[place] : "unknown";
}

std::string_view name(SolveStatus status) noexcept {
  return status == SolveStatus::optimal           ? "optimal"
         : status == SolveStatus::iteration_limit ? "iteration_limit"
                                                  : name(status_of(status));
}

Status status_of(SolveStatus status) noexcept {
  switch (status) {
    case SolveStatus::optimal:
      return Status::free;
    case SolveStatus::infeasible:
      return Status::infeasible;
    case SolveStatus::ill_posed:
      return Status::ill_posed;
    case SolveStatus::invalid_input:
      return Status::invalid_input;
    case SolveStatus::over_capacity:
      return Status::over_capacity;
    case SolveStatus::iteration_limit:
      break;
  }
  return Status::unsolved;
}

}  // namespace keepout
