// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "keepout/control/registration.h"
#include "keepout/step/motion_constraint.h"
#include "transport.h"

namespace keepout::crtk {

/// Draws the mesh, and the triangles and planes that limit a tip. It has a motion constraint of its
/// own, so that it does not touch that of the session. Allocates: a cycle draws rarely.
class Drawing {
 public:
  /// Draws the mesh. `guard`: like that of the session.
  Drawing(MotionConstraint guard, const Registration& registration, const std::string& frame,
          const std::string& topic, Transport& transport);

  /// Draws the triangles and planes that limit the motion of the tip to a goal, in the frame of the
  /// mesh [mm]. Does nothing if no process reads the topic.
  void draw(const Vec3& tip, const Vec3& goal);

 private:
  void add(Shape& shape, const Vec3& point) const;

  MotionConstraint guard_;
  Registration registration_;
  std::string frame_;
  Transport& transport_;
  int mesh_topic_;
  int topic_;
};

}  // namespace keepout::crtk
