// SPDX-License-Identifier: BSD-3-Clause
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>

#include <algorithm>
#include <vector>

#include "keepout/error.h"
#include "sweep.h"

// Debian ships Bullet in both precisions, and the one links with headers set for the other.
static_assert(sizeof(btScalar) == sizeof(double), "Bullet is used in double precision");

namespace keepout::peers {
namespace {

constexpr double allowed_penetration = 0.0;

btVector3 bullet(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

std::vector<double> coordinates_of(const Mesh& mesh) {
  std::vector<double> out;
  for (const Vec3& vertex : mesh.vertices()) out.insert(out.end(), vertex.begin(), vertex.end());
  return out;
}

std::vector<int> corners_of(const Mesh& mesh) {
  std::vector<int> out;
  for (const Corners& c : mesh.triangles()) out.insert(out.end(), c.begin(), c.end());
  return out;
}

class ConvexSweep : public Sweep {
 public:
  ConvexSweep(const Mesh& mesh, double radius)
      : points_(coordinates_of(mesh)),
        numbers_(corners_of(mesh)),
        arrays_(static_cast<int>(numbers_.size() / 3), numbers_.data(), 3 * sizeof(int),
                static_cast<int>(points_.size() / 3), points_.data(), 3 * sizeof(double)),
        shape_(&arrays_, true),
        ball_(radius) {
    shape_.setMargin(0.0);
    object_.setCollisionShape(&shape_);
    object_.setWorldTransform(btTransform::getIdentity());
  }

  double time_of_impact(const Vec3& tip, const Vec3& motion) const override {
    const btTransform from(btQuaternion::getIdentity(), bullet(tip));
    const btTransform to(btQuaternion::getIdentity(), bullet(tip + motion));
    btCollisionWorld::ClosestConvexResultCallback result(from.getOrigin(), to.getOrigin());
    btCollisionWorld::objectQuerySingle(&ball_, from, to, &object_, &shape_,
                                        object_.getWorldTransform(), result, allowed_penetration);
    return std::clamp(static_cast<double>(result.m_closestHitFraction), 0.0, 1.0);
  }

 private:
  std::vector<double> points_;  // the shape reads both lists
  std::vector<int> numbers_;
  btTriangleIndexVertexArray arrays_;
  btBvhTriangleMeshShape shape_;
  mutable btCollisionObject object_;  // Bullet asks for one that it might change
  btSphereShape ball_;
};

}  // namespace

std::unique_ptr<Sweep> convex_sweep(const Mesh& mesh, double radius) {
  // In Bullet's tree 21 bits hold the number of a triangle.
  constexpr std::size_t most_triangles = std::size_t{1} << 21;
  if (mesh.triangle_count() > most_triangles) throw Error("more triangles than Bullet can number");
  return std::make_unique<ConvexSweep>(mesh, radius);
}

}  // namespace keepout::peers
