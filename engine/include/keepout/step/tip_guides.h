// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "keepout/geometry/region.h"
#include "keepout/step/guide_state.h"
#include "keepout/step/motion_constraint.h"

namespace keepout {

/// A region that the tip of a tool is to stay in, whatever the hand asks for: a virtual fixture
/// that is no mesh.
struct TipGuide {
  std::string name;     // for messages and records
  Region region;        // in the frame of the mesh
  double band = 0.002;  // by how much it may be left, > 0 [length]
};

/// Keeps the tip of a MotionConstraint in regions as well: in a corridor, in a tube about a planned
/// line, on one side of a plane, all at once. Whatever comes out of the mesh's guarantee is kept:
/// regions only hold motions back further.
///
/// A tip that is in a region leaves it by no more than its band, one that is out comes no farther
/// out, on the whole straight motion; and what is out is led back by up to StepOptions::recovery a
/// cycle. Where regions contradict each other, or the mesh, they stop leading back, and that is
/// told. Why the end of a motion is enough: an excess is convex.
///
/// One for each control loop, beside its MotionConstraint. After construction it allocates nothing.
class TipGuides {
 public:
  static constexpr std::size_t most = 16;             // guides
  static constexpr std::size_t most_rows = 4 * most;  // that they pose at once

  /// Throws Error for more than `most`, or a band that is not above 0. `joints`: columns of the
  /// Jacobian at the most; `extra_rows`: of the caller's own, which go on being kept.
  explicit TipGuides(std::vector<TipGuide> guides, std::size_t joints = 3,
                     std::size_t extra_rows = 0);

  /// One control cycle: MotionConstraint::step within the regions. The guard's Capacity::extra_rows
  /// must hold the caller's rows and `rows()` more. Views stay valid until the next step; `active`
  /// beyond the planes is of rows: first the caller's, then the guides'.
  Step step(MotionConstraint& guard, const Motion& motion) noexcept {
    return step(guard, motion, nullptr, nullptr);
  }
  /// The same for one of several tips: see MotionConstraint::step.
  Step step(MotionConstraint& guard, const Motion& motion, SideWatch& sides) noexcept {
    return step(guard, motion, &sides, nullptr);
  }
  /// The same, and what the stages took of all trials.
  Step step(MotionConstraint& guard, const Motion& motion, StageTimes& times) noexcept {
    return step(guard, motion, nullptr, &times);
  }

  /// How each guide fared in the last step.
  std::span<const GuideState> states() const noexcept { return states_; }
  /// What gave way in it.
  Softening softening() const noexcept { return softening_; }
  /// What is guided.
  std::span<const TipGuide> guides() const noexcept { return guides_; }
  /// The most rows that they pose at once.
  std::size_t rows() const noexcept { return planes_.capacity(); }

 private:
  /// A plane that touches a guide's region.
  struct Plane {
    std::size_t guide;
    Vec3 normal;   // into the region
    double bound;  // of normal . motion; above 0 it leads back [length]
  };

  Step step(MotionConstraint& guard, const Motion& motion, SideWatch* sides,
            StageTimes* times) noexcept;
  void open(const Motion& motion) noexcept;
  Step solve(MotionConstraint& guard, const Motion& motion, SideWatch* sides,
             StageTimes* times) noexcept;
  bool add_violated(const Motion& motion, const Step& step) noexcept;
  void add(std::size_t guide, const Vec3& tip, const Vec3& at) noexcept;
  bool soften() noexcept;
  void cut(const Motion& motion, Step& step) noexcept;
  void tell(const Motion& motion, Step& step) noexcept;

  std::vector<TipGuide> guides_;
  std::vector<GuideState> states_;
  std::vector<double> allowed_;    // excess of each in this cycle [length]
  std::vector<std::size_t> held_;  // those that held the last motion back
  Buffer<Plane> planes_;
  std::vector<double> matrix_;
  std::vector<double> bounds_;
  std::vector<double> increment_;
  double recovery_ = 0.0;
  Softening softening_ = Softening::none;
};

}  // namespace keepout
