// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "keepout/activation/activation_rule.h"
#include "keepout/mesh/adjacency.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

class PaperBlocks;

/// Algorithm 1 of Li et al. (2020): three conditions on each triangle and its neighbors decide
/// which planes are active. For comparison only: the algorithm is not always safe, and not always
/// tight (docs/activation.md).
///
/// Notation of Li et al.: x is the tip, N_i the normal and CP_i the closest point of triangle T_i,
/// and CP_a the closest point of an adjacent triangle. Decisions where Li et al. are silent or
/// contradict themselves:
/// 1. Convexity refers to the anatomy: a convex edge is a ridge. Coplanar edges count as convex.
/// 2. CP_i == CP_a is an exact comparison: the kernel computes bitwise identical points for both
///    triangles of an edge.
/// 3. At a vertex, both edges of T_i that meet there count. Condition 2 has priority; Condition 3
///    applies if either edge is concave.
/// 4. All triangles with that closest point share the plane of Condition 2. A triangle does not add
///    it if a qualifying neighbor has a lower id.
/// 5. If the tip is on the surface, x - CP has no direction: the face plane {N_i, CP_i} is used.
/// 6. Boundary edges have no adjacent triangle, so neither condition can hold. The same applies to
///    non-manifold edges, and to edges whose two windings contradict each other.
/// 7. The sign of N_i^T (x - CP_i) is evaluated to within rounding.
class PaperRule final : public ActivationRule {
 public:
  PaperRule();
  ~PaperRule() override;

  /// Builds the adjacency of the mesh. If the index stores its triangles in blocks, the rule
  /// examines the blocks itself instead of making queries.
  void prepare(Neighborhood& neighborhood) override;
  bool gather(const RuleInput& input) noexcept override;
  bool makes_queries() const noexcept override { return blocks_ == nullptr; }
  std::size_t triangles() const noexcept override;
  Opening open(const RuleInput& input, HalfSpaceBuffer& planes) noexcept override;
  Judgement judge(const RuleInput& input, const Vec3& trial,
                  HalfSpaceBuffer& planes) noexcept override;

  /// Returns the plane that the conditions require for one triangle; empty if they require no
  /// plane. Does not read hits(). Precondition: prepare.
  std::optional<HalfSpace> plane_of(const RuleInput& input, const Hit& hit) const noexcept;

 private:
  enum class Role { none, speaks, leaves_it_to_a_neighbor };

  Role role_in_condition_2(const RuleInput& input, const Hit& hit) const noexcept;
  bool touches_a_valley(const Hit& hit) const noexcept;

  std::unique_ptr<const Adjacency> adjacency_;
  std::unique_ptr<PaperBlocks> blocks_;  // null if the index has no blocks
};

}  // namespace keepout
