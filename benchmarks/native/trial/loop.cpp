// SPDX-License-Identifier: BSD-3-Clause
#include "loop.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace keepout::trial {
namespace {

/// The mass, the spring and the damper of experiments/operator_model.py, at the handle.
/// Semi-implicit Euler: stable, because the damper acts on the velocity at the end of the cycle.
class Arm {
 public:
  Arm(const Settings& s, const Vec3& place) : s_(s), place_(place) {}

  const Vec3& move(const Vec3& intended, const Vec3& intended_speed, const Vec3& force) {
    const double mass = s_.mass / 1000.0;  // in N s^2/mm
    const Vec3 pull = s_.stiffness * (intended - place_) + s_.damping * intended_speed + force;
    speed_ = (speed_ + pull * (s_.period / mass)) / (1.0 + s_.damping * s_.period / mass);
    place_ = place_ + speed_ * s_.period;
    return place_;
  }
  const Vec3& speed() const { return speed_; }

 private:
  const Settings& s_;
  Vec3 place_, speed_ = Vec3::Zero();
};

double length_of(const Vec3& vector) { return std::sqrt(dot(vector, vector)); }

}  // namespace

Vec3 RigidMotion::turned(const Vec3& vector) const {
  return {dot(rotation[0], vector), dot(rotation[1], vector), dot(rotation[2], vector)};
}

Trace run(const Settings& s, Hand& hand, peers::Rule* rule) {
  const Path& path = s.path;
  const double scale = s.motion_scale;
  const double longest = std::min(s.radius, s.top_speed * s.period);
  const int delay = static_cast<int>(std::nearbyint(s.latency / s.period));
  const int force_delay = std::max(1, delay);  // the force of a cycle acts in the next one
  const double follow = s.lag == 0.0 ? 1.0 : 1.0 - std::exp(-s.period / s.lag);
  std::optional<Bone> bone;
  if (s.bone) bone.emplace(path, *s.bone, s.tip_stiffness);
  const Vec3 heading = path.heading / length_of(path.heading);

  const Vec3 start = path.place({0.0, 0.0, -s.start_height});
  Vec3 intended = start / scale;
  Arm arm(s, intended);
  const Vec3 first = s.registered.moved(start);
  Vec3 setpoint = first, robot = first;
  const Vec3 none = Vec3::Zero();
  const int approach = static_cast<int>(s.approach / s.period);
  std::vector<Vec3> goals, pulls;
  Trace out;

  for (int cycle = 0; cycle < s.cycles && !out.finished; ++cycle) {
    // The operator: the intended position.
    const auto now = static_cast<std::size_t>(cycle);
    const Coordinates aim = hand.aim(cycle, approach);
    const double above =
        std::max(0.0, 1.0 - static_cast<double>(cycle) / approach) * s.start_height;
    const auto [place, up] = path.at(aim.along);
    const Vec3 meant = (place + aim.across * path.across - (aim.below - above) * up) / scale;
    pulls.push_back(none);
    const Vec3 pull =
        cycle < force_delay ? none : pulls[static_cast<std::size_t>(cycle - force_delay)];
    const Vec3 speed = (meant - intended) / s.period;
    const Vec3 handle = arm.move(meant, speed, pull);
    intended = meant;

    // The robot: goal, fixture, setpoint, and the new position of the tip.
    goals.push_back(s.registered.moved(scale * handle + s.tremor[now]));
    const Vec3 goal = goals[static_cast<std::size_t>(std::max(0, cycle - delay))];
    Vec3 desired = goal - setpoint;
    const double length = length_of(desired);
    if (length > longest) desired = desired * (longest / length);
    if (!rule) {
      setpoint = setpoint + desired;
    } else {
      setpoint = setpoint + rule->step(setpoint, desired);
      Vec3 pulled = s.force_per_mm * (setpoint - goal);
      const double size = length_of(pulled);
      if (size > s.greatest_force) pulled = pulled * (s.greatest_force / size);
      pulls[now] = s.true_frame.turned(pulled);
    }
    robot = robot + follow * (setpoint - robot);
    Vec3 tip = s.true_frame.moved(robot);
    double contact = 0.0;
    if (bone) std::tie(tip, contact) = bone->press(tip, s.period);
    out.tip.push_back(tip);
    out.setpoint.push_back(setpoint);
    out.goal.push_back(goal);
    out.force.push_back(length_of(pulls[now]));
    out.power.push_back(dot(pull, arm.speed()));
    out.contact.push_back(contact);

    // The operator sees the tip from above, and feels the fixture.
    const Vec3 offset = tip - place;
    hand.look(
        {dot(offset, heading), dot(offset, path.across), -dot(offset, up), above, dot(pull, up)});
    // At the end the hand waits for a tip that lags behind.
    out.finished =
        aim.along >= path.length && path.coordinates(tip).along >= path.length - s.near_the_end;
  }
  out.begun = std::min(approach, static_cast<int>(out.tip.size()) - 1);
  if (bone) {
    out.kerf = bone->cut();
    out.kerf_rows = bone->rows();
    out.kerf_columns = bone->columns();
  }
  return out;
}

}  // namespace keepout::trial
