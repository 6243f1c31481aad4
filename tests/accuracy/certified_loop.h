// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numeric>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/pd_tree.h"
#include "keepout/judges/tip_judge.h"
#include "meshes.h"
#include "trials.h"

namespace keepout::test {

/// A mesh, its guard, and the oracle that judges the steps. The oracle shares no code with the
/// engine.
class Loop {
 public:
  Loop(Surface surface, const MotionConstraintSettings& settings)
      : mesh_(mesh_of(std::move(surface))),
        guard_(make_motion_constraint(mesh_, settings)),
        judged_(mesh_),
        oracle_(judged_.oracle()),
        options_(settings.options) {}

  const Mesh& mesh() const { return *mesh_; }
  const std::shared_ptr<const Mesh>& shared_mesh() const { return mesh_; }
  oracle::SafetyOracle& oracle() { return oracle_; }
  MotionConstraint& guard() { return guard_; }
  double margin() const { return required_clearance(options_); }
  double tolerance(const Vec3& tip) const { return judged_.tolerance(options_, tip); }

  Step step(const Vec3& tip, const Vec3& desired) {
    return guard_.step({.tip = tip, .desired = desired});
  }

  double distance(const Vec3& tip) const { return oracle_.distance(tip); }

  /// Returns the unit vector to the nearest point of the surface.
  Vec3 towards_surface(const Vec3& tip) const {
    const TriangleId nearest = oracle_.tree()->nearest(tip, oracle::narrow_distance).triangle;
    return closest_point(mesh_->triangle(nearest), tip).offset.normalized();
  }

  /// Returns the loss of clearance on the motion from `from` to `to`, in tolerances; at most 3 are
  /// promised. The reference is the margin or, if that is less, the distance at the start.
  double loss(const Vec3& from, const Vec3& to) {
    const double due = std::min(margin(), distance(from));
    const double tau = tolerance(from);
    const oracle::Finding finding = oracle_.check(from, to, std::max(due - 3.0 * tau, 0.0), due);
    return finding.crosses ? infinity : (due - finding.distance) / tau;
  }

 private:
  std::shared_ptr<const Mesh> mesh_;
  MotionConstraint guard_;
  oracle::JudgedSurface judged_;
  oracle::SafetyOracle oracle_;
  StepOptions options_;
};

/// The result of a step.
struct Cycle {
  Status status;
  Vec3 motion;

  bool operator==(const Cycle&) const = default;
};

/// Fails if the step is unsafe, or has a motion although it failed. Counts the steps that move.
inline void expect_safe(Loop& loop, const Vec3& tip, const Step& step, int& moved) {
  if (!step.ok()) {
    ASSERT_TRUE(step.motion.isZero(0.0)) << name(step.status);
    ASSERT_TRUE(step.increment.empty()) << name(step.status);
    return;
  }
  ASSERT_LE(loop.loss(tip, tip + step.motion), 3.0)
      << name(step.status) << " from " << tip.transpose() << " by " << step.motion.transpose();
  moved += step.motion.isZero(0.0) ? 0 : 1;
}

template <class T>
void shuffle(std::vector<T>& items, Random& random) {
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[random.below(i)]);
}

/// Returns the same triangles, with vertices and triangles shuffled and corners rotated.
inline Surface renumbered(const Surface& surface, Random& random) {
  std::vector<VertexId> new_vertex(surface.vertices.size());
  std::iota(new_vertex.begin(), new_vertex.end(), VertexId{0});
  shuffle(new_vertex, random);
  Surface out;
  out.vertices.resize(surface.vertices.size());
  for (std::size_t v = 0; v < new_vertex.size(); ++v) {
    out.vertices[new_vertex[v]] = surface.vertices[v];
  }
  for (Corners c : surface.triangles) {
    std::rotate(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(random.below(3)), c.end());
    for (VertexId& v : c) v = new_vertex[v];
    out.triangles.push_back(c);
  }
  shuffle(out.triangles, random);
  return out;
}

/// Returns the same triangles, each flipped at random.
inline Surface rewound(Surface surface, Random& random) {
  for (Corners& c : surface.triangles) {
    if (random.below(2) == 0) std::swap(c[1], c[2]);
  }
  return surface;
}

/// Returns up to `count` tips on the free side whose distance from the whole surface is `distance`.
inline std::vector<Vec3> places(Loop& loop, std::size_t count, double distance, Random& random) {
  std::vector<Vec3> out;
  // Points in narrow places are too close and are dropped. Otherwise one attempt suffices.
  for (int attempt = 0; attempt < 1'000 && out.size() < count; ++attempt) {
    for (const Vec3& p : surface_points(loop.mesh(), count, distance, random)) {
      if (out.size() < count && loop.distance(p) > (1.0 - 1e-9) * distance) out.push_back(p);
    }
  }
  return out;
}

}  // namespace keepout::test
