// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "../rules/rule.h"
#include "bone.h"
#include "hand.h"
#include "path.h"

namespace keepout::trial {

/// See experiments/set_up_errors.py.
struct RigidMotion {
  std::vector<Vec3> rotation;  // rows
  Vec3 translation;

  Vec3 turned(const Vec3& vector) const;
  Vec3 moved(const Vec3& point) const { return turned(point) + translation; }
};

/// All that a trial needs. Names and units are those of Course, Operator and SetUp in
/// experiments/.
struct Settings {
  Path path;
  std::optional<BoneProperties> bone;
  double force_per_mm, greatest_force, radius, top_speed, period;
  int cycles;
  double approach, near_the_end, start_height;
  double motion_scale, mass, stiffness, damping;
  double latency, lag, tip_stiffness;
  RigidMotion registered, true_frame;
  std::vector<Vec3> tremor;
};

/// See Trace in experiments/trial.py.
struct Trace {
  std::vector<Vec3> tip, setpoint, goal;
  std::vector<double> force, power, contact, kerf;
  int kerf_rows = 0, kerf_columns = 0, begun = 0;
  bool finished = false;
};

/// Simulates one trial: see experiments/trial.py. Without a rule there is no fixture.
/// tests/experiments/trial_in_python.py has the same operations in the same order.
Trace run(const Settings& settings, Hand& hand, peers::Rule* rule);

}  // namespace keepout::trial
