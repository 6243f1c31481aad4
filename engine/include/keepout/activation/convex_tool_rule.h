// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/activation/activation.h"
#include "keepout/geometry/convex_tool.h"
#include "keepout/geometry/narrow_phase.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Keeps a convex tool out of a mesh: a tool that stands as it does and moves with the tip, its
/// origin. Each triangle in reach gives the plane that separates it from the tool, margin and all.
/// Needs no winding: every surface is kept from on the side where the tool is.
///
/// Why the whole straight motion is safe: let n . p - n . v >= s for all points p of the tool and v
/// of the triangle. At a share t of the motion d their distance is at least s + t n . d, which is
/// linear in t, so that it is nowhere less than at one of the two ends: s, and s + n . d >= margin.
///
/// That holds for any n, and s is computed from the tool and the triangle themselves. So the narrow
/// phase only proposes normals: a bad one costs motion, and where it would forbid even to stand
/// still, or there is none, the exact kernel is asked.
///
/// Guarantee: dist(tool + t d, mesh) >= min(margin, dist(tool, mesh)) - tolerance, t in [0, 1]. A
/// tool that is too close is led off; one that touches the surface stands still.
class ConvexToolRule final : public Activation {
 public:
  /// Precondition: a narrow phase that is given is one of this tool; the exact one by default.
  ConvexToolRule(std::shared_ptr<const Mesh> mesh, ConvexTool tool,
                 std::unique_ptr<NarrowPhase> narrow_phase = nullptr);

  void reserve(std::size_t triangles) override;
  Reach reach() const noexcept override { return Reach::thales; }
  Ball region(const Surroundings& around) const noexcept override;
  Opening start(const Surroundings& around, HalfSpaceBuffer& planes) noexcept override;
  Judgement judge(const Surroundings& around, const Vec3& trial,
                  HalfSpaceBuffer& planes) noexcept override;
  bool relax(HalfSpaceBuffer& planes) const noexcept override;

  /// Distances are told apart down to this: some 1e-12 of the lengths at hand, and the rounding of
  /// a position. [length]
  double tolerance(const Surroundings& around) const noexcept;

  const ConvexTool& tool() const noexcept { return tool_; }

 private:
  /// A plane that has the triangle behind it and the tool as far before it as proven.
  struct Near {
    Vec3 normal;      // unit
    double distance;  // of the tool, proven [length]
    TriangleId triangle;
  };

  Near separated(const Surroundings& around, TriangleId triangle, double enough) noexcept;

  std::shared_ptr<const Mesh> mesh_;
  ConvexTool tool_;
  std::unique_ptr<NarrowPhase> narrow_phase_;
  double longest_edge_;  // of the mesh [length]
  Buffer<Near> near_;
};

}  // namespace keepout
