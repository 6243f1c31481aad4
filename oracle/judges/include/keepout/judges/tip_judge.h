// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

#include "keepout/oracle/safety_oracle.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"

namespace keepout::oracle {

/// A broken promise. The first six are those of docs/certified-step.md, for a tip.
enum class Breach : std::uint8_t {
  penetration,    // the motion of the tip touches the mesh
  too_near,       // a tip or a body comes closer to the mesh than it may
  too_long,       // the motion is longer than desired, or than the motion sphere allows
  moved_anyway,   // the step failed but has a motion, or its motion is not finite
  led_deeper,     // a tip on the forbidden side ends farther from the surface than it starts
  left_inside,    // a tip on the forbidden side makes another motion than a retreat
  limits_broken,  // a joint leaves its limits, or moves farther than a cycle allows
  guide_left,     // a guided point leaves its region by more than promised
  strayed         // a free motion ends farther from the target than zero motion
};
inline constexpr std::size_t breach_kinds = 9;
inline constexpr std::size_t tip_breach_kinds = 6;

std::string_view name(Breach breach) noexcept;

/// The verdict on one step of a tip.
struct TipVerdict {
  std::optional<Breach> breach;
  bool was_led_out = false;  // an escape from the forbidden side, which may cross the surface
  /// The distance of the whole motion from the mesh. Infinite if it exceeds the required clearance
  /// by more than a little, or if the tip was too close before. [length]
  double distance = std::numeric_limits<double>::infinity();
  double threshold = 0.0;             // the least distance allowed [length]
  double tolerance = 0.0;             // tau [length]
  TriangleId triangle = no_triangle;  // nearest to the motion
};

/// A mesh, with the properties that the judge of tips needs.
class JudgedSurface {
 public:
  explicit JudgedSurface(std::shared_ptr<const Mesh> mesh);

  const SafetyOracle& oracle() const noexcept { return oracle_; }
  double longest_edge() const noexcept { return longest_edge_; }  // [length]

  /// Returns true if a point is strictly on the side that the normals point away from.
  /// Precondition: the surface is closed and wound consistently.
  bool is_forbidden(const Vec3& point) const;

  /// Returns the tolerance tau of the certified rule, as docs/certified-step.md defines it.
  /// [length]
  double tolerance(const StepOptions& options, const Vec3& tip) const noexcept;

 private:
  SafetyOracle oracle_;
  double longest_edge_ = 0.0;
  bool free_inside_;  // the normals point into the enclosed volume
};

/// Follows one tip and checks each of its steps against the theorem, for the real numbers that the
/// tip's doubles represent. With the required clearance m, tool radius plus margin:
///
/// - A tip that was ever at least m - 2.75 tau away stays at least m - 3 tau away.
///
/// - A tip that is closer loses at most 3 tau in a step, and never reaches the surface.
///
/// - If tips must escape, a tip on the forbidden side does not get deeper. It may cross the
///   surface on its way out.
class TipJudge {
 public:
  /// `leads_out`: the surface has sides, and tips on the forbidden side must escape. The surface
  /// must outlive the judge.
  TipJudge(const JudgedSurface& surface, const StepOptions& options, bool leads_out,
           const Vec3& tip);

  /// Judges the motion from motion.tip to motion.tip + step.motion. Precondition: motion.tip is the
  /// end of the last step.
  TipVerdict judge(const Motion& motion, const Step& step);

 private:
  void take_in(const Vec3& tip);
  bool is_too_long(const Motion& motion, const Step& step) const noexcept;
  TipVerdict judge_way_out(const Motion& motion, const Vec3& to, TipVerdict verdict);

  const JudgedSurface* surface_;
  SafetyOracle oracle_;  // a copy, which caches the triangles near this tip alone
  StepOptions options_;
  bool leads_out_;
  bool has_kept_ = false;      // the tip had the required clearance in some cycle
  bool is_forbidden_ = false;  // the tip is on the forbidden side
  bool is_touching_ = false;   // the tip is within rounding of the surface
  double distance_ = 0.0;      // of the tip, unless has_kept_ [length]
};

}  // namespace keepout::oracle
