// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "keepout/fixtures/random.h"
#include "keepout/step/motion.h"
#include "setup.h"

namespace keepout::app {

/// What is asked of a tip, cycle by cycle: it sees where the tip is and where the surface is near,
/// and goes for it.
class Path {
 public:
  /// Both must outlive the path.
  Path(Scene& scene, Random& random, const Setup& setup);

  /// The increment to ask for, at most the setup's longest step. [length]
  Vec3 next(const Vec3& tip);

 private:
  void look(const Vec3& tip);
  Vec3 wish(const Vec3& tip);
  Vec3 target_on_triangle() const;

  Scene* scene_;
  Random* random_;
  Route route_;
  double longest_;  // step [length]
  double kept_;     // distance [length]
  std::size_t cycle_ = 0;
  std::size_t period_;     // of turning back, or choosing another goal [cycles]
  std::size_t attention_;  // how often it looks where the surface is [cycles]
  bool has_all_lengths_;   // steps of all lengths, not of the longest only
  double guess_ = 0.0;     // how far the surface is [length]
  TriangleId triangle_ = 0;
  Vec3 inwards_ = Vec3::UnitX();  // unit vector to the surface
  Vec3 heading_ = Vec3::UnitY();  // unit vector
  Vec3 goal_ = Vec3::Zero();
};

/// The joints of a robot, and what they may do.
class Joints {
 public:
  Joints(const Setup& setup, Random& random);

  /// The robot takes another pose now and then; returns the views that a step needs.
  void attach(Motion& motion);

 private:
  void draw();

  Random* random_;
  bool has_limits_;
  double longest_;  // step of the tip [length]
  std::size_t cycle_ = 0;
  TipJacobian::Matrix jacobian_;
  std::array<double, std::size_t{2} * 7 * 7> rows_{};  // row by row
  std::array<double, std::size_t{2} * 7> bounds_{};
};

}  // namespace keepout::app
