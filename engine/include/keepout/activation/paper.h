// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "keepout/activation/activation_rule.h"
#include "keepout/mesh/adjacency.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

class PaperBlocks;

/// Algorithm 1 of Li et al. 2020: three conditions on each triangle and its neighbors decide which
/// planes are active. Kept for comparison: it is not always safe, nor tight (docs/activation.md).
///
/// Where the paper is silent or contradicts itself, we decide:
/// - Convexity is that of the anatomy: convex is a ridge. Coplanar edges count as convex.
/// - CP_i == CP_a is exact: the kernel gives both triangles of an edge the same bits.
/// - At a vertex, both edges of T_i that meet there are asked. Condition 2 goes first; Condition 3
///   applies if either edge is concave.
/// - The plane of Condition 2 is shared by all triangles with that closest point. One whose
///   qualifying neighbor has a lower id leaves it to that neighbor.
/// - With the tip on the surface, x - CP has no direction: the face plane {N_i, CP_i} is taken.
/// - Boundary edges have no adjacent triangle, so neither condition can hold. Non-manifold edges,
///   and edges whose two windings contradict each other, are treated likewise.
/// - The sign of N_i^T (x - CP_i) is read to within rounding.
class PaperRule final : public ActivationRule {
 public:
  PaperRule();
  ~PaperRule() override;

  /// Builds the adjacency of the mesh. Looks at the leaves by itself where the index has its
  /// triangles in blocks.
  void prepare(Neighborhood& neighborhood) override;
  bool gather(const RuleInput& input) noexcept override;
  bool makes_queries() const noexcept override { return blocks_ == nullptr; }
  std::size_t triangles() const noexcept override;
  Opening open(const RuleInput& input, HalfSpaceBuffer& planes) noexcept override;
  Judgement judge(const RuleInput& input, const Vec3& trial,
                  HalfSpaceBuffer& planes) noexcept override;

  /// The plane that one triangle calls for, if it does. Asks no hits. Precondition: prepare.
  std::optional<HalfSpace> plane_of(const RuleInput& input, const Hit& hit) const noexcept;

 private:
  enum class Role { none, speaks, leaves_it_to_a_neighbor };

  Role role_in_condition_2(const RuleInput& input, const Hit& hit) const noexcept;
  bool touches_a_valley(const Hit& hit) const noexcept;

  std::unique_ptr<const Adjacency> adjacency_;
  std::unique_ptr<PaperBlocks> blocks_;  // where the index offers some
};

}  // namespace keepout
