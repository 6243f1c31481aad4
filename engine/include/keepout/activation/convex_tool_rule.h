// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "keepout/activation/activation_rule.h"
#include "keepout/geometry/convex_tool.h"
#include "keepout/geometry/separation.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Keeps a convex tool out of a mesh. The tool's origin is the tip. The tool moves with the tip and
/// does not turn. The rule accepts a motion only if planes prove that the whole tool stays clear.
/// The rule does not use the winding: the tool stays on its side of each surface.
///
/// Proof for a straight motion d: let n . p - n . v >= s for all points p of the tool and v of the
/// triangle. At a fraction t of d their distance is at least s + t n . d. That is linear in t, so
/// its least value is at an end: s, or s + n . d. The proof holds for any n, and the rule itself
/// computes s from the tool and the triangle. So the narrow phase only proposes normals. The rule
/// calls the exact kernel if a proposal proves too little, and at contacts.
///
/// The rule starts without planes. If a trial comes too close, it adds the plane of the first
/// contact. The triangle, grown by tool and margin, lies behind that plane. Planes at the tool's
/// start, one for each triangle, would also be safe. But they would stop a tool that slides over a
/// flat mesh at each inner edge.
///
/// Guarantee: dist(tool + t d, mesh) >= min(margin, dist(tool, mesh)) - 3 tolerance, t in [0, 1]. A
/// tool that is too close retreats. A tool that touches the surface does not move.
class ConvexToolRule final : public ActivationRule {
 public:
  /// Makes the rule of a tool. `narrow_phase`: for this tool; null for the exact kernel.
  explicit ConvexToolRule(ConvexTool tool, std::unique_ptr<NarrowPhase> narrow_phase = nullptr);

  void prepare(Neighborhood& neighborhood) override;
  bool guards_a_tool() const noexcept override { return true; }
  EndRegion end_region() const noexcept override { return EndRegion::target_ball; }
  Ball region(const RuleInput& input) const noexcept override;
  Opening open(const RuleInput& input, HalfSpaceBuffer& planes) noexcept override;
  Judgement judge(const RuleInput& input, const Vec3& trial,
                  HalfSpaceBuffer& planes) noexcept override;
  bool relax(HalfSpaceBuffer& planes) noexcept override;

  /// Returns the resolution of distances: about 1e-12 of the lengths involved, plus the rounding of
  /// a position. Precondition: prepare. [length]
  double tolerance(const RuleInput& input) const noexcept;

  /// Returns the tool.
  const ConvexTool& tool() const noexcept { return tool_; }

 private:
  /// A plane between a triangle and the tool at one position.
  struct Proof {
    Vec3 normal;      // unit
    double distance;  // the distance that it proves [length]
  };

  /// A triangle in the region, and the distances that the tool must maintain from it. [length]
  struct Near {
    TriangleId triangle;
    Proof at_start;
    bool is_refined;  // at_start comes from the narrow phase; other proofs may be much weaker
    double plane_level = 0.0;  // distance at which planes are put
    double demand = 0.0;       // a trial that comes closer is rejected
    double floor = 0.0;        // the least distance of a trial that satisfies the triangle's plane
  };

  /// A triangle that a trial may come too close to.
  struct Suspect {
    Near* near;
    double earliest;  // no contact comes before this fraction of the motion
  };

  struct Contact {
    double time;  // a fraction of the motion
    HalfSpace plane;
  };

  Proof proof_along(const Vec3& normal, const Vec3& position, TriangleId triangle) const noexcept;
  Proof quick_proof(const Hit& hit, const Vec3& position) const noexcept;
  Proof proof_of(double enough, const Vec3& position, TriangleId triangle) noexcept;
  void find_suspects(const RuleInput& input, const Vec3& trial) noexcept;
  bool keeps_clear(Near& near, const RuleInput& input, const Vec3& trial, double level,
                   std::span<const HalfSpace> planes) noexcept;
  std::optional<Contact> first_contact(const Near& near, const RuleInput& input, const Vec3& trial,
                                       double level, double latest) noexcept;

  ConvexTool tool_;
  std::unique_ptr<NarrowPhase> narrow_phase_;
  Buffer<Near> near_;         // sorted by triangle
  Buffer<Suspect> suspects_;  // of one trial, sorted by `earliest`
};

}  // namespace keepout
