// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/continuous_collision.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "keepout/error.h"
#include "sweep.h"

namespace keepout::peers {
namespace {

class FclSweep : public Sweep {
 public:
  FclSweep(const Mesh& mesh, double radius, fcl::CCDSolverType solver)
      : ball_(radius), solver_(solver) {
    const std::vector<fcl::Vector3d> vertices(mesh.vertices().begin(), mesh.vertices().end());
    std::vector<fcl::Triangle> triangles;
    for (const Corners& c : mesh.triangles()) triangles.emplace_back(c[0], c[1], c[2]);
    mesh_.beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
    mesh_.addSubModel(vertices, triangles);
    if (mesh_.endModel() != fcl::BVH_OK) throw Error("FCL does not take the mesh");
    mesh_.computeLocalAABB();
    ball_.computeLocalAABB();
  }

  SweepEnd operator()(const Vec3& tip, const Vec3& motion) const override {
    fcl::Transform3d at_rest = fcl::Transform3d::Identity(), from = at_rest, to = at_rest;
    from.translation() = tip;
    to.translation() = tip + motion;
    const double intervals = std::max(1.0, std::ceil(motion.norm() / (0.5 * ball_.radius)));
    fcl::ContinuousCollisionRequestd request;
    request.ccd_solver_type = solver_;
    request.num_max_iterations = static_cast<std::size_t>(intervals) + 1;
    request.toc_err = 0.5 / intervals;  // small enough for all intervals
    fcl::ContinuousCollisionResultd result;
    fcl::continuousCollide(&mesh_, at_rest, at_rest, &ball_, from, to, request, result);
    if (!result.is_collide) return {1.0, Vec3::Zero()};
    const double contact = result.time_of_contact;
    return {std::max(0.0, contact - 1.0 / intervals), normal_at(tip + contact * motion)};
  }

 private:
  /// Returns the normal of the deepest contact, towards the ball; zero without a contact.
  Vec3 normal_at(const Vec3& center) const {
    fcl::Transform3d at_rest = fcl::Transform3d::Identity(), pose = at_rest;
    pose.translation() = center;
    const fcl::CollisionRequestd request(1000, true);
    fcl::CollisionResultd result;
    fcl::collide(&mesh_, at_rest, &ball_, pose, request, result);
    std::vector<fcl::Contactd> contacts;
    result.getContacts(contacts);
    const auto deepest = std::max_element(
        contacts.begin(), contacts.end(),
        [](const auto& a, const auto& b) { return a.penetration_depth < b.penetration_depth; });
    return deepest == contacts.end() ? Vec3(Vec3::Zero()) : Vec3(deepest->normal);
  }

  fcl::BVHModel<fcl::OBBRSSd> mesh_;
  fcl::Sphered ball_;
  fcl::CCDSolverType solver_;
};

}  // namespace

std::unique_ptr<Sweep> continuous_collision(const Mesh& mesh, double radius) {
  return std::make_unique<FclSweep>(mesh, radius, fcl::CCDC_NAIVE);
}

std::unique_ptr<Sweep> conservative_advancement(const Mesh& mesh, double radius) {
  return std::make_unique<FclSweep>(mesh, radius, fcl::CCDC_CONSERVATIVE_ADVANCEMENT);
}

}  // namespace keepout::peers
