// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "keepout/step/motion.h"
#include "scene.h"
#include "setup.h"

namespace keepout::app {

/// What a step must never do.
enum class Breach : std::uint8_t {
  penetration,   // the way of the tip touches the mesh
  too_near,      // it comes closer than is allowed
  too_long,      // it is longer than asked for, or than the motion sphere allows
  moved_anyway,  // the step failed, and yet it moves; or its motion is no number
  led_deeper,    // a tip on the forbidden side ends farther from the surface than it was
  left_inside    // a tip on the forbidden side goes where it likes instead of out
};
inline constexpr std::size_t breach_kinds = 6;

std::string_view name(Breach breach) noexcept;

/// What the oracle says of one step.
struct Verdict {
  std::optional<Breach> breach;
  bool was_led_out = false;  // from the forbidden side: a crossing was meant
  /// Of the way from the mesh, when about what is to be kept or less, and that had not been lost
  /// before. [length]
  double distance = std::numeric_limits<double>::infinity();
  double threshold = 0.0;             // the least distance allowed [length]
  double tolerance = 0.0;             // tau [length]
  TriangleId triangle = no_triangle;  // nearest to the way
};

/// The certified rule's tolerance tau, by docs/certified-step.md and not by the engine. [length]
double tolerance(const Scene& scene, const StepOptions& options, const Vec3& tip) noexcept;

/// Follows one tip and holds each of its steps to the theorem, in terms of the doubles that the tip
/// consists of, as an independent oracle sees them; m is the distance kept, tool radius and margin
/// together:
///
/// - A tip that ever was at least m - 2.75 tau away stays at least m - 3 tau away.
/// - One that is closer loses at most 3 tau in a step, and never reaches the surface.
/// - Where the surface has sides and tips are to be led out, one on the forbidden side does not get
///   deeper; that it crosses the surface on its way out is meant.
class Judge {
 public:
  /// The scene must outlive the judge.
  Judge(const Scene& scene, const Setup& setup);

  /// The tip goes from motion.tip to motion.tip + step.motion. Precondition: it is where the last
  /// step led.
  Verdict judge(const Motion& motion, const Step& step);

 private:
  void take_in(const Vec3& tip);
  bool is_too_long(const Motion& motion, const Step& step) const noexcept;
  Verdict judge_way_out(const Motion& motion, const Vec3& to, Verdict verdict);

  const Scene* scene_;
  oracle::SafetyOracle oracle_;  // a fresh one, which remembers no other tip's surroundings
  StepOptions options_;
  bool has_sides_;             // and tips are to be led out
  bool has_kept_ = false;      // its distance, at some time
  bool is_forbidden_ = false;  // the tip is on the forbidden side
  bool is_touching_ = false;   // or so near that nobody can tell
  double distance_ = 0.0;      // of the tip, unless has_kept_ [length]
};

}  // namespace keepout::app
