// SPDX-License-Identifier: BSD-3-Clause
#include "convex_sweep.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>

#include <algorithm>
#include <vector>

#include "keepout/error.h"

// Debian ships Bullet in both precisions, and the one links with headers set for the other.
static_assert(sizeof(btScalar) == sizeof(double), "Bullet is used in double precision");

namespace keepout::peers {
namespace {

constexpr double allowed_penetration = 0.0;

btVector3 bullet(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

std::vector<double> coordinates_of(const Mesh& mesh) {
  std::vector<double> out;
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    for (const double x : mesh.vertex(v)) out.push_back(x);
  }
  return out;
}

std::vector<int> corners_of(const Mesh& mesh) {
  std::vector<int> out;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    for (const VertexId v : mesh.corners(t)) out.push_back(static_cast<int>(v));
  }
  return out;
}

}  // namespace

struct ConvexSweep::Bodies {
  Bodies(const Mesh& mesh, double radius)
      : points(coordinates_of(mesh)),
        numbers(corners_of(mesh)),
        arrays(static_cast<int>(numbers.size() / 3), numbers.data(), 3 * sizeof(int),
               static_cast<int>(points.size() / 3), points.data(), 3 * sizeof(double)),
        shape(&arrays, true),
        ball(radius) {
    shape.setMargin(0.0);
    object.setCollisionShape(&shape);
    object.setWorldTransform(btTransform::getIdentity());
  }

  std::vector<double> points;  // the shape reads both lists
  std::vector<int> numbers;
  btTriangleIndexVertexArray arrays;
  btBvhTriangleMeshShape shape;
  btCollisionObject object;
  btSphereShape ball;
};

ConvexSweep::ConvexSweep(const Mesh& mesh, double radius) {
  if (!(radius > 0.0)) throw Error("the ball needs a radius > 0");
  // In Bullet's tree 21 bits hold the number of a triangle.
  constexpr std::size_t most_triangles = std::size_t{1} << 21;
  if (mesh.triangle_count() > most_triangles) throw Error("more triangles than Bullet can number");
  bodies_ = std::make_unique<Bodies>(mesh, radius);
}

ConvexSweep::~ConvexSweep() = default;
ConvexSweep::ConvexSweep(ConvexSweep&&) noexcept = default;

double ConvexSweep::time_of_impact(const Vec3& tip, const Vec3& motion) const {
  const btTransform from(btQuaternion::getIdentity(), bullet(tip));
  const btTransform to(btQuaternion::getIdentity(), bullet(tip + motion));
  btCollisionWorld::ClosestConvexResultCallback result(from.getOrigin(), to.getOrigin());
  btCollisionWorld::objectQuerySingle(&bodies_->ball, from, to, &bodies_->object, &bodies_->shape,
                                      bodies_->object.getWorldTransform(), result,
                                      allowed_penetration);
  return std::clamp(static_cast<double>(result.m_closestHitFraction), 0.0, 1.0);
}

}  // namespace keepout::peers
