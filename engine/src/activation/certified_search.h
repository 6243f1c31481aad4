// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "certified_terms.h"
#include "frontier.h"
#include "keepout/activation/certified.h"
#include "keepout/index/wide_bvh.h"
#include "trial_walk.h"

namespace keepout {

/// The certified rule on a tree of its own: walks it along each trial motion, the nearest triangles
/// first, and stops at the first contact. Floats clear what is surely clear; what they leave over
/// is decided by the terms that all forms of the rule share, in double. So its answers are those of
/// CertifiedRule, bit for bit, and no screen, width of lanes, order or memory of earlier cycles can
/// change them.
class CertifiedSearch final : public Activation {
 public:
  /// `tree` must outlive this, and be over `mesh`. After a refit of it every start is refused, as
  /// over_capacity: the mesh is another one.
  CertifiedSearch(std::shared_ptr<const Mesh> mesh, const WideBvh& tree);

  bool searches() const noexcept override { return true; }
  std::size_t triangles(const Surroundings& around) const noexcept override;
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

  /// Where the searches of the last cycle began.
  const Frontier& frontier() const noexcept { return frontier_; }

 private:
  /// The first triangle that speaks against a trial.
  struct Meeting {
    Contact contact{2.0, {Vec3::Zero(), 0.0, no_triangle}};  // after any trial's end: none
    std::uint32_t facet = TrialWalk::no_note;                // its number
  };

  /// Walks along a trial to what it meets first. A triangle nearer to the tip than `too_close` ends
  /// the search: what speaks against the trial does not matter then, and facets_ has all that are
  /// as near. Whether nothing came near the trial, so that others like it are as free.
  bool meet(const Vec3& trial, std::span<const HalfSpace> planes, double too_close,
            Meeting& meeting) noexcept;
  bool is_over_budget() const noexcept;
  void begin(const Surroundings& around, const CertifiedTerms& terms) noexcept;
  void locate(const Surroundings& around) noexcept;
  const Facet* known(const TrialWalk::Leaf& leaf, std::size_t lane) const noexcept;
  Triangle corners(std::uint32_t leaf, std::size_t lane) const noexcept;
  const Facet& make_facet(TrialWalk::Leaf& leaf, std::size_t lane,
                          const Triangle& corners) noexcept;
  const Facet* nearest() const noexcept;
  const Facet& facet(TriangleId source) const noexcept;

  std::shared_ptr<const Mesh> mesh_;
  const WideBvh& tree_;
  std::uint64_t generation_;  // of the tree that is known here
  double longest_edge_;       // [length]

  Frontier frontier_;
  TrialWalk walk_;
  double farther_ = 0.0;  // than needed the next one is gathered [length]

  // Of this cycle.
  CertifiedTerms terms_{};
  Vec3 tip_ = Vec3::Zero();
  bool is_free_ = false;           // nothing is in reach
  bool aim_is_free_ = false;       // nothing comes near the motion asked for
  std::optional<Meeting> at_aim_;  // what it meets, planes apart, where that is known
  Buffer<Facet> facets_;           // that were asked about in double
};

}  // namespace keepout
