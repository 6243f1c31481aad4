// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include "fcl_model.h"
#include "keepout/geometry/ball_against_box.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/index/brute_force.h"

namespace keepout {
namespace {

// FCL tests a triangle by the distance to its plane, whose normal it gets from two edges: off by up
// to 4 u / s, of edges at an angle of sine s, with u = 2^-53. So a sphere may seem farther away by
// that share of the way to the triangle's far end. Where s is at least thin, the share is less than
// half of rounding, by which spheres are grown; thinner triangles are for us to test. And it takes
// the distance to a closest point that it has rounded as the coordinates are, wherever the mesh is.
constexpr double thin = 1e-5;
constexpr double rounding = 1e-10;
constexpr double coordinate_rounding = 1e-15;

// Beyond, FCL's squares of lengths may overflow.
constexpr double farthest = 1e150;  // [length]

/// Written so that what is no number is thin, and so is what is too small for its squares.
bool is_thin(const Triangle& corners) {
  const Vec3 one = corners[1] - corners[0];
  const Vec3 other = corners[2] - corners[0];
  const double squares = one.squaredNorm() * other.squaredNorm();
  return !(squares > 1e-200 && one.cross(other).squaredNorm() > thin * thin * squares);
}

/// FCL's tree, asked by FCL's own means for all triangles that a sphere touches. Oriented boxes
/// alone: of an OBBRSS collide() uses no more than those, and fits one to each sphere.
class FclCollideIndex final : public SpatialIndex {
 public:
  explicit FclCollideIndex(std::shared_ptr<const Mesh> on) : model_(std::move(on), "fcl_collide") {
    for (TriangleId t = 0; t < mesh().triangle_count(); ++t) {
      if (is_thin(mesh().triangle(t))) thin_.push_back(t);
    }
  }

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    try {
      if (ask(ball, candidates)) return;
    } catch (const std::exception&) {
      // No memory for FCL's list, and nothing is in ours yet: it is not for a query to throw.
    }
    BruteForce(model_.mesh()).collect(ball, candidates);
  }

  std::size_t memory() const noexcept override {
    return model_.memory() + thin_.capacity() * sizeof(TriangleId);
  }

 private:
  const Mesh& mesh() const noexcept { return *model_.mesh(); }

  /// False where FCL cannot tell.
  bool ask(const Ball& ball, TriangleBuffer& candidates) const {
    const Box& bounds = mesh().bounds();
    const double lengths =
        ball.radius + (ball.center - bounds.center()).cwiseAbs().sum() + bounds.size().sum();
    if (!(ball.radius >= 0.0 && lengths < farthest)) return false;
    const fcl::Sphered sphere(padded_radius(ball, bounds) + rounding * lengths +
                              coordinate_rounding * (ball.center.cwiseAbs().sum() + ball.radius));
    fcl::Transform3d pose = fcl::Transform3d::Identity();
    pose.translation() = ball.center;
    // One more than there is room for, so that an overflow shows.
    const std::size_t room = candidates.capacity() - candidates.size();
    const fcl::CollisionRequestd request(
        std::min(mesh().triangle_count(), room + 1 + thin_.size()));
    fcl::CollisionResultd result;
    fcl::collide(&model_.tree(), fcl::Transform3d::Identity(), &sphere, pose, request, result);
    for (std::size_t i = 0; i < result.numContacts(); ++i) {
      const auto t = static_cast<TriangleId>(result.getContact(i).b1);
      if (!std::ranges::binary_search(thin_, t)) candidates.push(t);
    }
    for (const TriangleId t : thin_) {
      if (closest_point(mesh().triangle(t), ball.center).distance <= ball.radius) {
        candidates.push(t);
      }
    }
    return true;
  }

  FclModel<fcl::OBBd> model_;
  std::vector<TriangleId> thin_;  // sorted
};

}  // namespace

std::unique_ptr<SpatialIndex> make_fcl_collide_index(std::shared_ptr<const Mesh> mesh) {
  return std::make_unique<FclCollideIndex>(std::move(mesh));
}

}  // namespace keepout
