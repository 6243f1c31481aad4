// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/status.h"

#include <array>
#include <cstddef>

namespace keepout {
namespace {

struct Outcome {
  std::string_view name;
  std::string_view reason;
};

// In the order of the enumeration.
constexpr std::array outcomes{
    Outcome{"free", "nothing holds the motion back"},
    Outcome{"limited", "planes of nearby triangles hold the motion back"},
    Outcome{"recovering", "the tip was closer than the margin, or inside: the motion leads it out"},
    Outcome{"fallback",
            "the best motion could not be proven within the budget of work: this is a shorter one "
            "that was"},
    Outcome{"yielding",
            "anatomy comes on faster than the instrument can give way: this motion is proven to "
            "keep less than the margin, how much is told; slow it down, or make room"},
    Outcome{"infeasible",
            "no motion satisfies all planes: the tip is closer than the margin on several sides, "
            "or the joints cannot move it away; retreat, or lower the margin"},
    Outcome{"ill_posed",
            "the Jacobian lacks full column rank, or all but, as it does with more than three "
            "joints: set damping above 0"},
    Outcome{"invalid_input",
            "a number is missing, not finite, beyond 1e15 (of a Jacobian or rows 1e30), or so far "
            "from the origin that the step is lost in its digits, or a Jacobian has other than 3 "
            "rows: check the tip, the increment and the Jacobian"},
    Outcome{"beyond_reach",
            "the motion is longer than the radius of the motion sphere: ask for less in a cycle, "
            "or declare a larger radius; are motion, radius and mesh in one unit, as mm?"},
    Outcome{"over_capacity",
            "more triangles, planes or joints than room was made for: lower the radius, or raise "
            "the capacity (of joints: Capacity::variables, max_joints in Python); or is the mesh "
            "in "
            "metres, so that a radius in mm holds all of it?"},
    Outcome{
        "unsolved",
        "no motion could be proven within the budget of work, the cycle's or the solver's: ask for "
        "a shorter one"},
    Outcome{
        "inside",
        "the tip is on the forbidden side, deeper than `deepest`, or a Jacobian, rows or too small "
        "a recovery keep it from being led out: lead it out by hand, or by steps without them; if "
        "it is outside, the mesh is wound inside out"},
    Outcome{"touching",
            "the tip touches the surface, and which side is free cannot be told: move it off by "
            "hand"},
    Outcome{"margin_too_small",
            "the margin is lost in the rounding of lengths this large: raise the margin or the "
            "tool radius, or move the origin closer; or is the mesh in micrometres?"},
    Outcome{"mesh_changed",
            "the index was refit to another mesh: have the motion constraint follow it, and look "
            "where the tip is now"},
};
static_assert(outcomes.size() == status_count);

constexpr Outcome unknown{"unknown", "unknown status"};

const Outcome& outcome_of(Status status) noexcept {
  const auto place = static_cast<std::size_t>(status);
  return place < outcomes.size() ? outcomes[place] : unknown;
}

}  // namespace

std::string_view name(Status status) noexcept { return outcome_of(status).name; }

std::string_view reason(Status status) noexcept { return outcome_of(status).reason; }

}  // namespace keepout
