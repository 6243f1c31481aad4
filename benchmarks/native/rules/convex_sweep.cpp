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

// Debian ships Bullet in both precisions; headers and library of different precision link without
// an error.
static_assert(sizeof(btScalar) == sizeof(double), "Bullet is used in double precision");
static_assert(sizeof(keepout::Vec3) == 3 * sizeof(double) &&
              sizeof(keepout::Corners) == 3 * sizeof(int));

namespace keepout::peers {
namespace {

constexpr double allowed_penetration = 0.0;

btVector3 bullet(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

class ConvexSweep : public Sweep {
 public:
  ConvexSweep(const Mesh& mesh, double radius)
      : points_(mesh.vertices().begin(), mesh.vertices().end()),
        corners_(mesh.triangles().begin(), mesh.triangles().end()),
        arrays_(static_cast<int>(corners_.size()), reinterpret_cast<int*>(corners_.data()),
                sizeof(Corners), static_cast<int>(points_.size()), points_.front().data(),
                sizeof(Vec3)),
        shape_(&arrays_, true),
        ball_(radius) {
    shape_.setMargin(0.0);
    object_.setCollisionShape(&shape_);
    object_.setWorldTransform(btTransform::getIdentity());
  }

  SweepEnd operator()(const Vec3& tip, const Vec3& motion) const override {
    const btTransform from(btQuaternion::getIdentity(), bullet(tip));
    const btTransform to(btQuaternion::getIdentity(), bullet(tip + motion));
    btCollisionWorld::ClosestConvexResultCallback result(from.getOrigin(), to.getOrigin());
    btCollisionWorld::objectQuerySingle(&ball_, from, to, &object_, &shape_,
                                        object_.getWorldTransform(), result, allowed_penetration);
    if (!result.hasHit()) return {1.0, Vec3::Zero()};
    const btVector3& n = result.m_hitNormalWorld;
    return {std::clamp(static_cast<double>(result.m_closestHitFraction), 0.0, 1.0),
            {n.x(), n.y(), n.z()}};
  }

 private:
  std::vector<Vec3> points_;  // the shape refers to both lists
  std::vector<Corners> corners_;
  btTriangleIndexVertexArray arrays_;
  btBvhTriangleMeshShape shape_;
  mutable btCollisionObject object_;  // Bullet wants an object that it may change
  btSphereShape ball_;
};

}  // namespace

std::unique_ptr<Sweep> convex_sweep(const Mesh& mesh, double radius) {
  // Bullet's tree stores the number of a triangle in 21 bits.
  constexpr std::size_t most_triangles = std::size_t{1} << 21;
  if (mesh.triangle_count() > most_triangles) throw Error("more triangles than Bullet can number");
  return std::make_unique<ConvexSweep>(mesh, radius);
}

}  // namespace keepout::peers
