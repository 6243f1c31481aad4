// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/config.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/AABB.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "../src/index_module.h"
#include "keepout/error.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/geometry/shapes.h"
#include "keepout/index/brute_force.h"
#include "keepout/mesh/mesh.h"

namespace keepout {
namespace {

/// FCL counts nodes by an int, 2 n - 1 for n triangles, and 2 n must not overflow.
constexpr std::size_t fcl_most_triangles = (std::size_t{1} << 30) - 1;

/// Grows FCL's box until it contains the vertex.
void include(fcl::AABBd& box, const Vec3& vertex) {
  box.min_ = box.min_.cwiseMin(vertex);
  box.max_ = box.max_.cwiseMax(vertex);
}

void include(fcl::OBBd& box, const Vec3& vertex) {
  const Vec3 local = box.axis.transpose() * (vertex - box.To);
  box.extent = box.extent.cwiseMax(local.cwiseAbs());
}

/// Replaces an invalid box by an empty one around the vertex.
void start_anew(fcl::AABBd& box, const Vec3& vertex) { box = fcl::AABBd(vertex); }

void start_anew(fcl::OBBd& box, const Vec3& vertex) {
  box = fcl::OBBd(Eigen::Matrix3d::Identity(), vertex, Vec3::Zero());
}

/// Returns true if distances to the box are valid.
bool is_sound(const fcl::AABBd& box) { return box.min_.allFinite() && box.max_.allFinite(); }

/// Returns true if lengths in the frame of the box are those of the mesh, up to the rounding by
/// which the radius is padded. They are for FCL's axes, unless the squares of the coordinates
/// overflow.
bool is_sound(const fcl::OBBd& box) {
  const Eigen::Matrix3d gram = box.axis.transpose() * box.axis;
  const double skew = (gram - Eigen::Matrix3d::Identity()).cwiseAbs().sum();
  // False for NaN.
  return skew <= 3e-14 && box.To.allFinite() && box.extent.allFinite();
}

double squared_distance(const fcl::AABBd& box, const Vec3& point) noexcept {
  return (box.min_ - point).cwiseMax(point - box.max_).cwiseMax(0.0).squaredNorm();
}

double squared_distance(const fcl::OBBd& box, const Vec3& point) noexcept {
  const Vec3 local = box.axis.transpose() * (point - box.To);
  return (local.cwiseAbs() - box.extent).cwiseMax(0.0).squaredNorm();
}

// Only the oriented box of an OBBRSS is used.
void include(fcl::OBBRSSd& volume, const Vec3& vertex) { include(volume.obb, vertex); }
void start_anew(fcl::OBBRSSd& volume, const Vec3& vertex) { start_anew(volume.obb, vertex); }
bool is_sound(const fcl::OBBRSSd& volume) { return is_sound(volume.obb); }
double squared_distance(const fcl::OBBRSSd& volume, const Vec3& point) noexcept {
  return squared_distance(volume.obb, point);
}

/// FCL's tree over a mesh. Each box is made to contain its triangles. Derived classes traverse the
/// tree.
template <class Volume>
class FclModel : public SpatialIndex {
 public:
  /// `name`: of the index.
  FclModel(std::shared_ptr<const Mesh> on, std::string_view name) : SpatialIndex(std::move(on)) {
    require_at_most(fcl_most_triangles, mesh().triangle_count(), "triangles", name);
    require_at_most(std::numeric_limits<int>::max(), mesh().vertex_count(), "vertices", name);
    build();
    std::vector<TriangleId> triangles;
    triangles.reserve(mesh().triangle_count());
    hold_triangles(0, triangles);
    if (triangles.size() != mesh().triangle_count()) throw Error("FCL lost triangles of the mesh");
  }

  std::size_t memory() const noexcept override {
    const auto nodes = static_cast<std::size_t>(model_.getNumBVs());
    return nodes * (sizeof(fcl::BVNode<Volume>) + sizeof(unsigned)) +
           static_cast<std::size_t>(model_.num_tris) * sizeof(fcl::Triangle) +
           static_cast<std::size_t>(model_.num_vertices) * sizeof(fcl::Vector3d);
  }

 protected:
  const fcl::BVHModel<Volume>& tree() const noexcept { return model_; }

 private:
  void build() {
    const std::vector<fcl::Vector3d> vertices(mesh().vertices().begin(), mesh().vertices().end());
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(mesh().triangle_count());
    for (const Corners& corners : mesh().triangles()) {
      triangles.emplace_back(corners[0], corners[1], corners[2]);
    }
    // Without declared counts FCL allocates more memory than it needs.
    if (model_.beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size())) !=
            fcl::BVH_OK ||
        model_.addSubModel(vertices, triangles) != fcl::BVH_OK ||
        model_.endModel() != fcl::BVH_OK) {
      throw Error("FCL could not build its tree; is there enough memory?");
    }
  }

  /// Makes each box contain its triangles. FCL's oriented boxes exclude corners by up to 1e-10 of
  /// their size: one box in eight on a CT skull. Appends the triangles of the subtree.
  void hold_triangles(int node, std::vector<TriangleId>& triangles) {
    fcl::BVNode<Volume>& at = model_.getBV(node);
    const std::size_t first = triangles.size();
    if (at.isLeaf()) {
      triangles.push_back(static_cast<TriangleId>(at.primitiveId()));
    } else {
      hold_triangles(at.leftChild(), triangles);
      hold_triangles(at.rightChild(), triangles);
    }
    if (!is_sound(at.bv)) start_anew(at.bv, mesh().triangle(triangles[first])[0]);
    for (const TriangleId t : std::span(triangles).subspan(first)) {
      for (const Vec3& corner : mesh().triangle(t)) include(at.bv, corner);
    }
  }

  fcl::BVHModel<Volume> model_;
};

/// FCL's tree, traversed here: FCL's own collide() also tests the triangles, and allocates memory.
template <class Volume>
class FclIndex final : public FclModel<Volume> {
 public:
  static constexpr std::string_view name =
      std::is_same_v<Volume, fcl::AABBd> ? "fcl_aabb" : "fcl_obbrss";

  explicit FclIndex(std::shared_ptr<const Mesh> on) : FclModel<Volume>(std::move(on), name) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const double reach = padded_radius(ball, this->mesh().bounds());
    visit(0, ball.center, reach * reach, candidates);
  }

 private:
  // Recursive, like FCL's own build. FCL splits at the mean, so only the range of a double bounds
  // the depth, at about two thousand halvings.
  void visit(int node, const Vec3& point, double squared_reach,
             TriangleBuffer& candidates) const noexcept {
    const fcl::BVNode<Volume>& at = this->tree().getBV(node);
    if (squared_distance(at.bv, point) > squared_reach) return;
    if (at.isLeaf()) {
      candidates.push(static_cast<TriangleId>(at.primitiveId()));
      return;
    }
    if (candidates.overflowed()) return;
    visit(at.leftChild(), point, squared_reach, candidates);
    visit(at.rightChild(), point, squared_reach, candidates);
  }
};

// FCL tests a triangle by the distance to its plane, whose normal it computes from two edges. With
// u = 2^-53, the normal is off by up to 4 u / s, for edges at an angle of sine s. So a sphere may
// seem farther away, by that fraction of the distance to the triangle's far end. If s is at least
// `thin`, the fraction is less than half of the rounding by which spheres are grown. Thinner
// triangles are tested here. FCL also computes the distance to a closest point that is rounded like
// the coordinates, wherever the mesh is.
constexpr double thin = 1e-5;
constexpr double length_rounding = 1e-10;
constexpr double coordinate_rounding = 1e-15;

// Beyond this, FCL's squares of lengths may overflow.
constexpr double farthest = 1e150;  // [length]

/// Also true for NaN, and for triangles whose squares underflow.
bool is_thin(const Triangle& corners) {
  const Vec3 one = corners[1] - corners[0];
  const Vec3 other = corners[2] - corners[0];
  const double squares = one.squaredNorm() * other.squaredNorm();
  return !(squares > 1e-200 && one.cross(other).squaredNorm() > thin * thin * squares);
}

/// FCL's tree, searched by FCL's own collide() for all triangles that a sphere touches. It uses
/// oriented boxes: collide() uses only these of an OBBRSS, and fits one to each sphere. It
/// allocates memory during a query, so it is for comparison and not for real time.
class FclCollideIndex final : public FclModel<fcl::OBBd> {
 public:
  static constexpr std::string_view name = "fcl_collide";

  explicit FclCollideIndex(std::shared_ptr<const Mesh> on) : FclModel(std::move(on), name) {
    for (TriangleId t = 0; t < mesh().triangle_count(); ++t) {
      if (is_thin(mesh().triangle(t))) thin_.push_back(t);
    }
  }

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    try {
      if (ask(ball, candidates)) return;
    } catch (const std::exception&) {
      // FCL has no memory for its list, and `candidates` is still empty. A query must not throw.
    }
    BruteForce(shared_mesh()).collect(ball, candidates);
  }

  std::size_t memory() const noexcept override {
    return FclModel::memory() + thin_.capacity() * sizeof(TriangleId);
  }

 private:
  /// Returns false if FCL cannot answer.
  bool ask(const Ball& ball, TriangleBuffer& candidates) const {
    const Box& bounds = mesh().bounds();
    const double lengths =
        ball.radius + (ball.center - bounds.center()).cwiseAbs().sum() + bounds.size().sum();
    if (!(ball.radius >= 0.0 && lengths < farthest)) return false;
    const fcl::Sphered sphere(padded_radius(ball, bounds) + length_rounding * lengths +
                              coordinate_rounding * (ball.center.cwiseAbs().sum() + ball.radius));
    fcl::Transform3d pose = fcl::Transform3d::Identity();
    pose.translation() = ball.center;
    // One more than the capacity, so that an overflow is visible.
    const std::size_t room = candidates.capacity() - candidates.size();
    const fcl::CollisionRequestd request(
        std::min(mesh().triangle_count(), room + 1 + thin_.size()));
    fcl::CollisionResultd result;
    fcl::collide(&tree(), fcl::Transform3d::Identity(), &sphere, pose, request, result);
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

}  // namespace keepout

const std::span<const keepout::IndexBackend> keepout_indices = keepout::backends;
