// SPDX-License-Identifier: BSD-3-Clause
// libccd computes the depth of an overlap, but no distance of separate bodies. Their distance
// follows from the depth after the tool is grown by more than the distance.
#include <algorithm>
#include <cmath>

#include "../src/ccd_bodies.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "keepout/geometry/closest_point.h"

namespace keepout {
namespace {

constexpr int budget_of_a_pair = 800;  // support queries; tens are usual
constexpr unsigned long most_iterations = 200;
// EPA also compares squares of lengths with it. With a smaller value EPA may never end.
constexpr double tolerance = 1e-16;

using Penetration = int (*)(const void*, const void*, const ccd_t*, ccd_real_t*, ccd_vec3_t*,
                            ccd_vec3_t*);

class CcdNarrowPhase final : public NarrowPhase {
 public:
  CcdNarrowPhase(const ConvexTool& tool, Penetration penetration)
      : tool_(tool), penetration_(penetration) {}

  NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept override {
    if (!is_in_range(position, triangle)) return NarrowPhaseAnswer::failed("out of range");
    const Triangle local = relative(triangle, position);
    const NarrowPhaseAnswer overlap = depth(local, 0.0);
    if (overlap.answered() || overlap.failure != apart) return moved(overlap, position);
    // An upper bound: the distance of a point of the tool.
    const double at_most = closest_point(local, tool_.points().front()).distance - tool_.radius();
    const double growth = std::max(at_most, 0.0) + 0.1 * tool_.bounding_ball().radius;
    return moved(depth(local, growth), position);
  }

 private:
  static constexpr std::string_view apart = "libccd found no overlap";

  /// Returns the separation, from an overlap with the tool grown beyond its radius.
  NarrowPhaseAnswer depth(const Triangle& local, double growth) const noexcept {
    CcdBudget budget{budget_of_a_pair};
    const CcdTriangle first{&local, &budget};
    const CcdTool second{&tool_, tool_.radius() + growth, &budget};
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = ccd_triangle_support;
    ccd.support2 = ccd_tool_support;
    ccd.center1 = ccd_triangle_center;
    ccd.center2 = ccd_tool_center;
    ccd.max_iterations = most_iterations;
    ccd.epa_tolerance = ccd.mpr_tolerance = ccd.dist_tolerance = tolerance;
    ccd_real_t depth = 0.0;
    ccd_vec3_t direction{};
    ccd_vec3_t place{};
    const int outcome = penetration_(&first, &second, &ccd, &depth, &direction, &place);
    if (budget.spent()) return NarrowPhaseAnswer::failed("libccd did not converge");
    if (outcome == -1) return NarrowPhaseAnswer::failed(apart);
    if (outcome != 0) return NarrowPhaseAnswer::failed("libccd ran out of memory");
    const Separation s{growth - depth, from_ccd(direction), from_ccd(place)};
    const bool usable = std::isfinite(s.distance) && s.on_triangle.allFinite() &&
                        std::abs(s.normal.squaredNorm() - 1.0) < 1e-9;
    if (!usable) return NarrowPhaseAnswer::failed("libccd returned NaN, infinity or no direction");
    return {s, {}};
  }

  static NarrowPhaseAnswer moved(NarrowPhaseAnswer answer, const Vec3& by) noexcept {
    answer.separation.on_triangle += by;
    return answer;
  }

  ConvexTool tool_;
  Penetration penetration_;
};

template <Penetration penetration>
std::unique_ptr<NarrowPhase> make(const ConvexTool& tool) {
  return std::make_unique<CcdNarrowPhase>(tool, penetration);
}

// The header has no version, and the package states 2.0 for version 2.1.
std::string library() { return "libccd " KEEPOUT_CCD_VERSION; }

constexpr NarrowPhaseBackend backends[] = {
    {"ccd_gjk", "GJK, and EPA for the depth", make<ccdGJKPenetration>, Allocation::inside, library},
    {"ccd_mpr", "Minkowski portal refinement: its depth is not the least", make<ccdMPRPenetration>,
     Allocation::inside, library},
};

}  // namespace

}  // namespace keepout

const std::span<const keepout::NarrowPhaseBackend> keepout_narrow_phases = keepout::backends;
