// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "keepout/control/registration.h"
#include "keepout/step/motion_constraint.h"
#include "postbox.h"
#include "transport.h"

namespace keepout::crtk {

/// Draws the mesh, and the triangles and planes that limit a tip. It has a thread and a motion
/// constraint of its own, so the cycle of the session neither waits nor allocates.
class Drawing {
 public:
  /// Draws the mesh. `guard`: like that of the session.
  Drawing(MotionConstraint guard, const Registration& registration, const std::string& frame,
          const std::string& topic, Transport& transport);

  /// Lets the thread draw the triangles and planes that limit the motion of the tip to a goal, in
  /// the frame of the mesh [mm]. It draws only if a process reads the topic. Never waits.
  void draw(const Vec3& tip, const Vec3& goal) {
    box_.post([&](Motion& motion) { motion = {tip, goal}; });
  }

 private:
  struct Motion {
    Vec3 tip = Vec3::Zero(), goal = Vec3::Zero();
  };

  void draw(const Motion& motion);
  void add(Shape& shape, const Vec3& point) const;

  MotionConstraint guard_;
  Registration registration_;
  std::string frame_;
  Transport& transport_;
  int mesh_topic_;
  int topic_;
  Postbox<Motion, 2> box_;
};

}  // namespace keepout::crtk
