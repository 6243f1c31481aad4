// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/continuous_collision.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "keepout/error.h"
#include "sweep.h"

namespace keepout::peers {
namespace {

class ContinuousCollision : public Sweep {
 public:
  ContinuousCollision(const Mesh& mesh, double radius) : ball_(radius) {
    const std::vector<fcl::Vector3d> vertices(mesh.vertices().begin(), mesh.vertices().end());
    std::vector<fcl::Triangle> triangles;
    for (const Corners& c : mesh.triangles()) triangles.emplace_back(c[0], c[1], c[2]);
    mesh_.beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
    mesh_.addSubModel(vertices, triangles);
    if (mesh_.endModel() != fcl::BVH_OK) throw Error("FCL does not take the mesh");
    mesh_.computeLocalAABB();
    ball_.computeLocalAABB();
  }

  double time_of_impact(const Vec3& tip, const Vec3& motion) const override {
    fcl::Transform3d at_rest = fcl::Transform3d::Identity(), from = at_rest, to = at_rest;
    from.translation() = tip;
    to.translation() = tip + motion;
    const double intervals = std::max(1.0, std::ceil(motion.norm() / (0.5 * ball_.radius)));
    fcl::ContinuousCollisionRequestd request;
    request.ccd_solver_type = fcl::CCDC_NAIVE;
    request.num_max_iterations = static_cast<std::size_t>(intervals) + 1;
    request.toc_err = 0.5 / intervals;  // small enough for all intervals
    fcl::ContinuousCollisionResultd result;
    fcl::continuousCollide(&mesh_, at_rest, at_rest, &ball_, from, to, request, result);
    return result.is_collide ? std::max(0.0, result.time_of_contact - 1.0 / intervals) : 1.0;
  }

 private:
  fcl::BVHModel<fcl::OBBRSSd> mesh_;
  fcl::Sphered ball_;
};

}  // namespace

std::unique_ptr<Sweep> continuous_collision(const Mesh& mesh, double radius) {
  return std::make_unique<ContinuousCollision>(mesh, radius);
}

}  // namespace keepout::peers
