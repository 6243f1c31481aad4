// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "keepout/activation/activation_rule.h"
#include "keepout/activation/facet.h"
#include "keepout/activation/first_contact.h"
#include "keepout/index/motion_walk.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

struct CertifiedTerms;

/// The certified rule: a motion is accepted only if each triangle that it could come near is proven
/// to keep its distance from the whole of it. Needs no adjacency, winding or convexity: the tip
/// keeps off open, non-manifold and self-intersecting surfaces alike, on both sides.
///
/// It starts without planes. To a trial that comes too close it adds the plane of the first
/// contact, which has that triangle, grown by the required clearance, behind it; each triangle gets
/// at most one plane in a search. Proof: docs/certified-step.md. Search and tolerances:
/// docs/certified-step-algorithm.md.
///
/// The triangles come from the index, by a walk along each trial motion. The rule judges them here,
/// in double, one triangle at a time: so the answers are bitwise identical on every index, whatever
/// it left out as surely clear.
///
/// Guarantee, for every motion dx that judge() accepts, under the assumptions of
/// docs/certified-step.md: dist(x + s dx, mesh) >= min(clearance, dist(x, mesh)) - 3 tolerance for
/// all s in [0, 1].
class CertifiedRule final : public ActivationRule {
 public:
  CertifiedRule();
  ~CertifiedRule() override;

  void prepare(Neighborhood& near) override;
  bool makes_queries() const noexcept override;
  EndRegion end_region() const noexcept override { return EndRegion::target_ball; }
  Ball region(const CycleProblem& problem) const noexcept override;
  bool gather(const CycleProblem& problem) noexcept override;
  Opening open(const CycleProblem& problem, HalfSpaceBuffer& planes) noexcept override;
  Judgement judge(const CycleProblem& problem, const Vec3& trial,
                  HalfSpaceBuffer& planes) noexcept override;
  bool relax(HalfSpaceBuffer& planes) noexcept override;
  bool relinearize(const CycleProblem& problem, std::span<const HalfSpace> planes,
                   HalfSpaceBuffer& next) noexcept override;
  void add_alternatives(TriangleId source, HalfSpaceBuffer& planes) const noexcept override;
  std::size_t triangles() const noexcept override { return facets_.size(); }

  /// Returns tau, the tolerance of distances at a tip: 2e-10 of longest edge, radius and clearance,
  /// plus 4e-16 of the 1-norm of the tip. It depends on the whole mesh and not on the triangles
  /// found, so no index can change it.
  /// Precondition: prepare. [length]
  double tolerance(const CycleProblem& problem) const noexcept;

 private:
  /// The first triangle that speaks against a trial.
  struct Meeting {
    Contact contact{MotionWalk::after_the_end, {Vec3::Zero(), 0.0, no_triangle}};
    std::uint32_t facet = Encounter::no_note;  // its number in facets_; no_note if there is none
  };
  /// A walk along a trial.
  struct Passage {
    Meeting first;
    bool nothing_near = false;  // neither this trial nor one like it comes near anything
  };
  class FirstMeeting;

  Passage pass_along(const Vec3& trial, std::span<const HalfSpace> planes,
                     double too_close) noexcept;
  template <class Accepts>
  const Facet* nearest(const Accepts& accepts) const noexcept;
  void choose_walls(const Facet& first, double too_close) noexcept;
  void add_planes_of_walls(HalfSpaceBuffer& planes) noexcept;
  const Facet& facet(TriangleId source) const noexcept;

  std::unique_ptr<MotionWalk> walk_;

  // Of this cycle.
  std::unique_ptr<CertifiedTerms> terms_;
  bool target_is_free_ = false;       // nothing comes near the target
  std::optional<Meeting> at_target_;  // what the target meets without planes, if known
  Buffer<Facet> facets_;  // that were examined; a triangle may be there twice: Encounter
  static constexpr std::size_t most_walls = 12;
  Buffer<Facet> walls_{most_walls};  // near a tip that is too close, one for each direction, until
                                     // their planes are added
};

}  // namespace keepout
