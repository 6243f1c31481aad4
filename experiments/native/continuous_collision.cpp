// SPDX-License-Identifier: BSD-3-Clause
#include "continuous_collision.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/continuous_collision.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "keepout/error.h"

namespace keepout::peers {

struct ContinuousCollision::Bodies {
  explicit Bodies(double radius) : ball(radius) { ball.computeLocalAABB(); }

  fcl::BVHModel<fcl::OBBRSSd> mesh;
  fcl::Sphered ball;
};

ContinuousCollision::ContinuousCollision(const Mesh& mesh, double radius) {
  if (!(radius > 0.0)) throw Error("the ball needs a radius > 0");
  std::vector<fcl::Vector3d> vertices;
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) vertices.push_back(mesh.vertex(v));
  std::vector<fcl::Triangle> triangles;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Corners& c = mesh.corners(t);
    triangles.emplace_back(c[0], c[1], c[2]);
  }
  auto bodies = std::make_unique<Bodies>(radius);
  bodies->mesh.beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  bodies->mesh.addSubModel(vertices, triangles);
  if (bodies->mesh.endModel() != fcl::BVH_OK) throw Error("FCL does not take the mesh");
  bodies->mesh.computeLocalAABB();
  bodies_ = std::move(bodies);
}

ContinuousCollision::~ContinuousCollision() = default;
ContinuousCollision::ContinuousCollision(ContinuousCollision&&) noexcept = default;

double ContinuousCollision::time_of_impact(const Vec3& tip, const Vec3& motion) const {
  fcl::Transform3d at_rest = fcl::Transform3d::Identity(), from = at_rest, to = at_rest;
  from.translation() = tip;
  to.translation() = tip + motion;
  const double intervals = std::max(1.0, std::ceil(motion.norm() / (0.5 * bodies_->ball.radius)));
  fcl::ContinuousCollisionRequestd request;
  request.ccd_solver_type = fcl::CCDC_NAIVE;
  request.num_max_iterations = static_cast<std::size_t>(intervals) + 1;
  request.toc_err = 0.5 / intervals;  // asks for no fewer
  fcl::ContinuousCollisionResultd result;
  fcl::continuousCollide(&bodies_->mesh, at_rest, at_rest, &bodies_->ball, from, to, request,
                         result);
  return result.is_collide ? std::max(0.0, result.time_of_contact - 1.0 / intervals) : 1.0;
}

}  // namespace keepout::peers
