// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "keepout/activation/activation_rule.h"
#include "keepout/activation/first_contact.h"
#include "keepout/activation/prepared_triangle.h"
#include "keepout/index/motion_traversal.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

struct CertifiedTerms;

/// The certified rule: it accepts a motion only if it proves that the whole motion stays clear of
/// each triangle that the motion could come near. It needs no adjacency, winding or convexity. The
/// tip stays clear of open, non-manifold and self-intersecting surfaces alike, on both sides.
///
/// It starts without planes. If a trial comes too close, the rule adds the plane of the first
/// contact. That triangle, grown by the required clearance, lies behind the plane. Each triangle
/// gets at most one plane in a search. Proof: docs/certified-step.md. Search and tolerances:
/// docs/certified-step-algorithm.md.
///
/// The index finds the triangles by a traversal along each trial motion. The rule judges each
/// triangle in double precision. The answers are therefore bitwise identical on every index, even
/// if an index skips triangles that are surely clear.
///
/// Guarantee for every motion dx that judge() accepts (assumptions: docs/certified-step.md):
/// dist(x + s dx, mesh) >= min(clearance, dist(x, mesh)) - 3 tolerance for all s in [0, 1].
class CertifiedRule final : public ActivationRule {
 public:
  CertifiedRule();
  ~CertifiedRule() override;

  void prepare(Neighborhood& neighborhood) override;
  bool makes_queries() const noexcept override;
  EndRegion end_region() const noexcept override { return EndRegion::target_ball; }
  Ball region(const RuleInput& input) const noexcept override;
  bool gather(const RuleInput& input) noexcept override;
  Opening open(const RuleInput& input, HalfSpaceBuffer& planes) noexcept override;
  Judgement judge(const RuleInput& input, const Vec3& trial,
                  HalfSpaceBuffer& planes) noexcept override;
  bool relax(HalfSpaceBuffer& planes) noexcept override;
  bool relinearize(const RuleInput& input, std::span<const HalfSpace> planes,
                   HalfSpaceBuffer& next) noexcept override;
  void add_alternatives(TriangleId triangle, HalfSpaceBuffer& planes) const noexcept override;
  std::size_t triangles() const noexcept override { return prepared_.size(); }

  /// Returns tau, the tolerance of distances at a tip: 2e-10 (longest edge + radius + clearance) +
  /// 4e-16 (1-norm of the tip). It depends on the whole mesh and not on the triangles found, so it
  /// is the same on every index. Precondition: prepare. [length]
  double tolerance(const RuleInput& input) const noexcept;

 private:
  /// The result of a traversal along a trial.
  struct Passage {
    /// The first contact that forbids the trial.
    Contact contact{MotionTraversal::never, {Vec3::Zero(), 0.0, no_triangle}};
    /// The index in prepared_ of the triangle of the contact; no_note without a contact.
    std::uint32_t prepared = MotionTraversal::no_note;
    bool is_too_close = false;  // a triangle is too close to the tip: contacts are meaningless
    bool nothing_near = false;  // neither this trial nor a similar one comes near a triangle

    bool has_contact() const noexcept { return prepared != MotionTraversal::no_note; }
  };
  class ContactSearch;

  void forget_prepared_triangles(double level) noexcept;
  Passage traverse_along(const Vec3& trial, std::span<const HalfSpace> planes,
                         double too_close) noexcept;
  template <class Accepts>
  const PreparedTriangle* nearest(const Accepts& accepts) const noexcept;
  void choose_walls(const PreparedTriangle& first, double too_close) noexcept;
  void add_planes_of_walls(HalfSpaceBuffer& planes) noexcept;
  const PreparedTriangle& prepared(TriangleId triangle) const noexcept;

  std::unique_ptr<MotionTraversal> traversal_;

  // State of this cycle.
  std::unique_ptr<CertifiedTerms> terms_;
  /// The traversal along the target without planes, if open() made it. judge() uses it for the
  /// first trial, which is the target.
  std::optional<Passage> at_target_;
  /// The prepared triangles that were examined. The notes of the traversal are indices into this
  /// buffer, so the traversal begins again whenever the buffer is cleared. The buffer holds a
  /// triangle twice if the traversal forgot its note.
  Buffer<PreparedTriangle> prepared_;
  static constexpr std::size_t most_walls = 12;
  /// Triangles near a tip that is too close, one for each direction, until their planes are added.
  Buffer<PreparedTriangle> walls_{most_walls};
};

}  // namespace keepout
