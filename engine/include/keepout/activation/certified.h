// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/activation/activation.h"
#include "keepout/activation/facet.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

struct CertifiedTerms;

/// The certified rule: no motion is accepted unless each triangle in reach is proven to keep its
/// distance from the whole of it. Needs no adjacency, winding or convexity: open, non-manifold and
/// self-intersecting surfaces are all kept from, on both sides.
///
/// It starts without planes. To a trial that comes too close it answers with the plane of the first
/// contact, which has that triangle, grown by the margin, behind it; so each triangle is answered
/// at most once in a round. Algorithm, proof and tolerances: docs/certified-step.md.
///
/// Guarantee: dist(x + s dx, mesh) >= min(margin, dist(x, mesh)) - 3 tolerance for all s in [0, 1].
class CertifiedRule final : public Activation {
 public:
  /// The rule on a mesh. Precondition: it is not null.
  explicit CertifiedRule(std::shared_ptr<const Mesh> mesh);
  ~CertifiedRule() override;

  /// On a WideBvh: CertifiedSearch.
  std::unique_ptr<Activation> searching(const SpatialIndex& index) const override;

  void reserve(std::size_t triangles) override;
  Reach reach() const noexcept override { return Reach::thales; }
  Ball region(const Surroundings& around) const noexcept override;
  Opening start(const Surroundings& around, HalfSpaceBuffer& planes) noexcept override;
  Judgement judge(const Surroundings& around, const Vec3& trial,
                  HalfSpaceBuffer& planes) noexcept override;
  bool relax(HalfSpaceBuffer& planes) const noexcept override;
  bool turn(const Surroundings& around, std::span<const HalfSpace> planes,
            HalfSpaceBuffer& turned) noexcept override;
  void ways_around(const Surroundings& around, TriangleId source,
                   HalfSpaceBuffer& ways) const noexcept override;

  /// Distances are told apart down to this: some 1e-10 of the largest lengths at hand. It comes
  /// from the whole mesh, not from the triangles found, so that no index can change it. [length]
  double tolerance(const Surroundings& around) const noexcept;

 private:
  const Facet& facet(TriangleId source) const noexcept;

  std::shared_ptr<const Mesh> mesh_;
  double longest_edge_;                    // [length]
  std::unique_ptr<CertifiedTerms> terms_;  // of this cycle
  Buffer<Facet> facets_;                   // in reach, sorted by source
  std::size_t proofs_ = 0;                 // asked for in this cycle
};

}  // namespace keepout
