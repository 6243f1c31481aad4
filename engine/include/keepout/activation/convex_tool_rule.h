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

/// Keeps a convex tool out of a mesh: a tool that stands as it does and moves with the tip, its
/// origin. No motion is accepted unless planes prove that all of it keeps its distance. Needs no
/// winding: every surface is kept from on the side where the tool is.
///
/// Why a plane is proof of a whole straight motion d: let n . p - n . v >= s for all points p of
/// the tool and v of the triangle. At a share t of d their distance is at least s + t n . d, which
/// is linear in t and so nowhere less than at both ends: s, and s + n . d.
///
/// It starts without planes. To a trial that comes too close it answers with the plane of the first
/// contact: it has the triangle behind it, grown by tool and margin, and allows the motion up to
/// there. A plane for each triangle from where the tool stands would be sound as well, but a tool
/// that slides over a flat mesh would stumble over its inner edges.
///
/// That holds for any n, and s is computed from the tool and the triangle themselves. So the narrow
/// phase only proposes normals; where a proposal proves too little, or there is none, and at
/// contacts, the exact kernel is asked.
///
/// Guarantee: dist(tool + t d, mesh) >= min(margin, dist(tool, mesh)) - 3 tolerance, t in [0, 1]. A
/// tool that is too close is led off; one that touches the surface stands still.
class ConvexToolRule final : public ActivationRule {
 public:
  /// Precondition: a narrow phase that is given is one of this tool; the exact one by default.
  explicit ConvexToolRule(ConvexTool tool, std::unique_ptr<NarrowPhase> narrow_phase = nullptr);

  void prepare(Neighborhood& near) override;
  bool guards_a_tool() const noexcept override { return true; }
  EndRegion end_region() const noexcept override { return EndRegion::target_ball; }
  Ball region(const CycleProblem& problem) const noexcept override;
  Opening open(const CycleProblem& problem, HalfSpaceBuffer& planes) noexcept override;
  Judgement judge(const CycleProblem& problem, const Vec3& trial,
                  HalfSpaceBuffer& planes) noexcept override;
  bool relax(HalfSpaceBuffer& planes) noexcept override;

  /// Distances are told apart down to this: some 1e-12 of the lengths at hand, and the rounding of
  /// a position. Precondition: prepare. [length]
  double tolerance(const CycleProblem& problem) const noexcept;

  /// What is kept out.
  const ConvexTool& tool() const noexcept { return tool_; }

 private:
  /// A plane that keeps a triangle from the tool at some place.
  struct Proof {
    Vec3 normal;      // unit
    double distance;  // that it proves [length]
  };

  /// A triangle in reach, and the distances that it is due. [length]
  struct Near {
    TriangleId triangle;
    Proof at_start;
    double clearance;  // planes are placed this far off
    double demand;     // a trial that comes closer is objected to
    double floor;      // what a trial that its plane allows may come down to
  };

  struct Contact {
    double time;  // a share of the motion
    HalfSpace plane;
  };

  Proof proof_along(const Vec3& normal, const Vec3& position, TriangleId triangle) const noexcept;
  Proof proof_of(double enough, const Vec3& position, TriangleId triangle) noexcept;
  bool keeps_clear(const Near& near, const CycleProblem& problem, const Vec3& trial, double level,
                   std::span<const HalfSpace> planes) const noexcept;
  std::optional<Contact> first_contact(const Near& near, const CycleProblem& problem,
                                       const Vec3& trial, double level) noexcept;

  ConvexTool tool_;
  std::unique_ptr<NarrowPhase> narrow_phase_;
  Buffer<Near> near_;  // sorted by triangle
};

}  // namespace keepout
