// SPDX-License-Identifier: BSD-3-Clause
// FCL's GJK after libccd has assertions that fail near a touch. Debian builds the library with
// assertions, and they end the process. The functions are static ones of a header, so this file
// compiles them without assertions. GJK, EPA and GJKSolver_indep<double> are extern templates of
// the library. This file compiles only their callers for a shape and a triangle.
#ifndef NDEBUG
#define NDEBUG
#endif

#include <fcl/config.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk_libccd.h>
#include <fcl/narrowphase/detail/gjk_solver_indep.h>

#include <cmath>
#include <exception>
#include <vector>

#include "../src/ccd_bodies.h"
#include "keepout/adapters/narrow_phase_registry.h"

namespace keepout {
namespace {

constexpr int budget_of_a_pair = 400;  // support queries; tens are usual
constexpr unsigned int most_iterations = 200;
constexpr double tolerance = 1e-12;
// Between the bounds of a depth. EPA is exact at corners when it ends. With a smaller tolerance it
// may never end.
constexpr double tolerance_of_depth = 1e-6;

/// Returns an answer from the signed distance of the cores. `direction` is from the triangle's
/// point to the core's, or the reverse if they overlap.
NarrowPhaseAnswer answer(double distance, const Vec3& direction, const Vec3& on_triangle,
                         const ConvexTool& tool, const Vec3& position) noexcept {
  const double length = direction.norm();
  const bool usable = std::isfinite(distance) && on_triangle.allFinite() && std::isfinite(length);
  if (!usable) return NarrowPhaseAnswer::failed("FCL returned NaN or infinity");
  if (!(length > 0.0)) return NarrowPhaseAnswer::failed("FCL returned no direction");
  return {{distance - tool.radius(), direction / length, position + on_triangle}, {}};
}

// Both methods get the tool's core, because GJK is most exact on corners. The radius is subtracted
// afterwards.

/// GJK and EPA of libccd, as rewritten in FCL.
class FclGjkLibccd final : public NarrowPhase {
 public:
  explicit FclGjkLibccd(const ConvexTool& tool) : tool_(tool) {}

  NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept override {
    if (!is_in_range(position, triangle)) return NarrowPhaseAnswer::failed("out of range");
    const Triangle local = relative(triangle, position);
    CcdBudget budget{budget_of_a_pair};
    CcdTool core{&tool_, 0.0, &budget};
    CcdTriangle other{&local, &budget};
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = ccd_tool_support;
    ccd.support2 = ccd_triangle_support;
    ccd.max_iterations = most_iterations;
    ccd.dist_tolerance = tolerance;
    ccd.epa_tolerance = tolerance_of_depth;
    double distance = 0.0;
    ccd_vec3_t first{};
    ccd_vec3_t second{};
    try {
      // GJKSignedDistance, which calls this function, belongs to the library.
      distance =
          fcl::detail::libccd_extension::ccdGJKSignedDist(&core, &other, &ccd, &first, &second);
    } catch (const std::exception&) {
      return NarrowPhaseAnswer::failed("FCL threw: its polytope was not what it expects");
    } catch (...) {
      return NarrowPhaseAnswer::failed("FCL threw");
    }
    if (budget.spent()) return NarrowPhaseAnswer::failed("FCL did not converge");
    const Vec3 on_core = from_ccd(first);
    const Vec3 on_triangle = from_ccd(second);
    // FCL's failure is a distance of -1, which can also be a depth. The points distinguish them.
    const Vec3 between = distance < 0.0 ? on_triangle - on_core : on_core - on_triangle;
    if (distance == -1.0 && between.isZero(0.0)) {
      return NarrowPhaseAnswer::failed("FCL did not converge");
    }
    return answer(distance, between, on_triangle, tool_, position);
  }

 private:
  ConvexTool tool_;
};

/// FCL's other pair, after Bullet.
class FclGjkIndep final : public NarrowPhase {
 public:
  explicit FclGjkIndep(const ConvexTool& tool)
      : tool_(tool),
        core_(std::make_shared<const std::vector<Vec3>>(tool.points().begin(), tool.points().end()),
              0, std::make_shared<const std::vector<int>>()) {
    solver_.gjk_max_iterations = most_iterations;
    solver_.epa_max_iterations = most_iterations;
    solver_.gjk_tolerance = tolerance;
    solver_.epa_tolerance = tolerance;
  }

  NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept override {
    if (!is_in_range(position, triangle)) return NarrowPhaseAnswer::failed("out of range");
    // FCL returns points in the frame of the shape, contrary to its documentation.
    const Triangle local = relative(triangle, position);
    const fcl::Transform3d here = fcl::Transform3d::Identity();
    double distance = 0.0;
    Vec3 on_core = Vec3::Zero();
    Vec3 on_triangle = Vec3::Zero();
    try {
      if (solver_.shapeTriangleDistance(core_, here, local[0], local[1], local[2], &distance,
                                        &on_core, &on_triangle)) {
        return answer(distance, on_core - on_triangle, on_triangle, tool_, position);
      }
      Vec3 normal = Vec3::Zero();
      if (!solver_.shapeTriangleIntersect(core_, here, local[0], local[1], local[2], &on_triangle,
                                          &distance, &normal)) {
        return NarrowPhaseAnswer::failed("FCL found neither a distance nor an overlap");
      }
      // The depth may have either sign.
      return answer(-std::abs(distance), normal, on_triangle, tool_, position);
    } catch (...) {
      return NarrowPhaseAnswer::failed("FCL threw");
    }
  }

 private:
  ConvexTool tool_;
  fcl::Convexd core_;  // without faces, which only volumes need
  fcl::detail::GJKSolver_indep<double> solver_;
};

template <class Phase>
std::unique_ptr<NarrowPhase> make(const ConvexTool& tool) {
  return std::make_unique<Phase>(tool);
}

std::string library() { return "FCL " FCL_VERSION; }

constexpr NarrowPhaseBackend backends[] = {
    {"fcl_gjk_libccd", "GJK and EPA of FCL, after libccd", make<FclGjkLibccd>, Allocation::inside,
     library},
    {"fcl_gjk_indep", "GJK and EPA of FCL, its own", make<FclGjkIndep>, Allocation::inside,
     library},
};

}  // namespace

}  // namespace keepout

const std::span<const keepout::NarrowPhaseBackend> keepout_narrow_phases = keepout::backends;
