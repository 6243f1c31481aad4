// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/activation/certified.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/motion_constraint.h"
#include "meshes.h"

namespace keepout {

/// The complete result of a step.
struct Outcome {
  Status status;
  Vec3 motion;
  std::vector<double> increment;
  std::vector<HalfSpace> planes;
  std::optional<double> distance;

  explicit Outcome(const Step& step)
      : status(step.status),
        motion(step.motion),
        increment(step.increment.begin(), step.increment.end()),
        planes(step.planes.begin(), step.planes.end()),
        distance(step.distance) {}

  /// Ignores the sources of planes: they may differ if triangles coincide.
  friend bool operator==(const Outcome& a, const Outcome& b) {
    return a.status == b.status && a.motion == b.motion && a.increment == b.increment &&
           a.distance == b.distance &&
           std::equal(a.planes.begin(), a.planes.end(), b.planes.begin(), b.planes.end(),
                      [](const HalfSpace& p, const HalfSpace& q) {
                        return p.normal == q.normal && p.offset == q.offset;
                      });
  }
};

inline std::unique_ptr<MotionConstraint> guard(const std::shared_ptr<const Mesh>& mesh,
                                               std::shared_ptr<const SpatialIndex> index,
                                               const StepOptions& options) {
  return std::make_unique<MotionConstraint>(
      mesh, std::move(index), std::make_unique<CertifiedRule>(), std::make_unique<ActiveSet>(),
      options, Capacity{.nodes = 16, .work_units = Budget::unlimited});
}

/// The rule on one mesh with two indices: one traverses along motions, one only answers queries.
class Sources {
 public:
  explicit Sources(Surface surface)
      : mesh(mesh_of(std::move(surface))),
        tree(std::make_shared<WideBvh>(mesh)),
        traversing_(guard(mesh, tree, harmless())),
        asking_(guard(mesh, std::make_shared<PdTree>(mesh), harmless())) {}

  Outcome traversing(const Motion& motion) { return Outcome(traversing_->step(motion)); }
  Outcome asking(const Motion& motion) { return Outcome(asking_->step(motion)); }
  Outcome traversing(const Motion& motion, const StepOptions& options) {
    traversing_->set_options(options);
    return traversing(motion);
  }
  Outcome asking(const Motion& motion, const StepOptions& options) {
    asking_->set_options(options);
    return asking(motion);
  }
  /// Sets the options of all later steps.
  void set_options(const StepOptions& options) {
    traversing_->set_options(options);
    asking_->set_options(options);
  }

  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<WideBvh> tree;

 private:
  StepOptions harmless() const {
    const double size = mesh->bounds().size().norm();
    return {.radius = size, .margin = size};
  }

  std::unique_ptr<MotionConstraint> traversing_;
  std::unique_ptr<MotionConstraint> asking_;
};

}  // namespace keepout
