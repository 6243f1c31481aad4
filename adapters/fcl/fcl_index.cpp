// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/config.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <exception>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "fcl_model.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/index/brute_force.h"

namespace keepout {
namespace {

/// FCL's tree, walked by us: its own collide() tests the triangles as well, and takes memory.
template <class Volume>
class FclIndex final : public SpatialIndex {
 public:
  static constexpr std::string_view name =
      std::is_same_v<Volume, fcl::AABBd> ? "fcl_aabb" : "fcl_obbrss";

  explicit FclIndex(std::shared_ptr<const Mesh> mesh) : model_(std::move(mesh), name) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const double reach = padded_radius(ball, model_.mesh()->bounds());
    visit(0, ball.center, reach * reach, candidates);
  }

  std::size_t memory() const noexcept override { return model_.memory(); }

 private:
  // Recursive, as FCL's own build is: it splits at the mean, so that a depth has no bound but the
  // range of a double, some two thousand halvings.
  void visit(int node, const Vec3& point, double squared_reach,
             TriangleBuffer& candidates) const noexcept {
    const fcl::BVNode<Volume>& at = model_.tree().getBV(node);
    if (squared_distance(at.bv, point) > squared_reach) return;
    if (at.isLeaf()) {
      candidates.push(static_cast<TriangleId>(at.primitiveId()));
      return;
    }
    visit(at.leftChild(), point, squared_reach, candidates);
    visit(at.rightChild(), point, squared_reach, candidates);
  }

  FclModel<Volume> model_;
};

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

/// FCL's tree, asked by FCL's own collide() for all triangles that a sphere touches. Oriented boxes
/// alone: of an OBBRSS collide() uses no more than those, and fits one to each sphere. Takes memory
/// while it answers: for comparison, not for real time.
class FclCollideIndex final : public SpatialIndex {
 public:
  static constexpr std::string_view name = "fcl_collide";

  explicit FclCollideIndex(std::shared_ptr<const Mesh> on) : model_(std::move(on), name) {
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

std::string library() { return "FCL " FCL_VERSION; }

constexpr IndexBackend backends[] = {
    {FclIndex<fcl::OBBRSSd>::name, "oriented boxes of FCL", make_index_of<FclIndex<fcl::OBBRSSd>>,
     fcl_most_triangles, library},
    {FclIndex<fcl::AABBd>::name, "axis-aligned boxes of FCL", make_index_of<FclIndex<fcl::AABBd>>,
     fcl_most_triangles, library},
    {FclCollideIndex::name,
     "oriented boxes of FCL, by its own collide(): takes memory, not for real time",
     make_index_of<FclCollideIndex>, fcl_most_triangles, library, Allocation::inside,
     "FCL's collide() also tests each triangle, and makes a list of contacts on the heap at each "
     "query; the contact points are not asked for."},
};

}  // namespace

std::span<const IndexBackend> fcl_indices() noexcept { return backends; }

}  // namespace keepout
