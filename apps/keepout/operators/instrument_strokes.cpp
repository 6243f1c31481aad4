// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "keepout/error.h"
#include "operators/strokes.h"
#include "operators/tremor.h"

namespace keepout::app {
namespace {

constexpr double pass_lasts = 400.0;  // at speed 1 [cycles]
constexpr int starts_to_lean = 12;    // the best of these is used

/// A place on an instrument, with the direction and the distance to the surface.
struct Facing {
  Vec3 at = Vec3::Zero();
  Vec3 inwards = Vec3::UnitZ();                               // unit vector to the surface
  double distance = std::numeric_limits<double>::infinity();  // [mm]
};

/// Returns the place on a part of a body's axis that is nearest to the surface. `from` and `to`:
/// fractions of the axis.
Facing facing(Scene& scene, const monitor::Segment& axis, double from, double to) {
  constexpr int places = 24;
  Facing best;
  for (int i = 0; i <= places; ++i) {
    const Vec3 at = axis.from + (from + (to - from) * i / places) * (axis.to - axis.from);
    const ClosestPoint closest = scene.nearest(at).closest;
    if (closest.distance < best.distance && closest.distance > 0.0) {
      best = {at, closest.offset / closest.distance, closest.distance};
    }
  }
  return best;
}

/// One motion in and back.
struct Pass {
  double depth = 0.0;            // below the surface [mm]
  double slide = 0.0;            // along the surface, to and fro [mm]
  Vec3 heading = Vec3::UnitX();  // of the slide, unit
  double turn = 0.0;             // to and fro [rad]
  Vec3 axis = Vec3::UnitX();     // of the turn, unit
};

Pass draw_pass(Manner manner, const Vec3& inwards, Random& random) {
  const bool is_rotating = manner == Manner::rotate;
  Pass pass;
  pass.depth = is_rotating ? random.uniform(0.0, 3.0) : random.uniform(2.0, 12.0);
  pass.slide = is_rotating ? 0.0 : random.uniform(0.0, 20.0);
  pass.heading = inwards.cross(random.direction()).normalized();
  pass.turn = is_rotating ? random.uniform(0.5, 1.2) : random.uniform(0.0, 0.2);
  pass.axis = random.direction();
  return pass;
}

}  // namespace

Stroke instrument_stroke(RobotScene& on, const StrokeSettings& settings, std::uint64_t number,
                         double speed) {
  Random of_seed(settings.seed);
  Random random(of_seed.bits() ^ number);
  Stroke stroke{.manner = manners[number % manners.size()], .speed = speed, .number = number};
  const bool is_leaning = stroke.manner == Manner::lean;
  const bool has_port = on.robot.has_port();
  std::optional<RobotStart> start;
  Facing facing_most;
  for (int i = 0; i < (is_leaning ? starts_to_lean : 1); ++i) {
    const auto drawn = on.start(random);
    if (!drawn) break;
    const monitor::JudgedRobot judged = on.robot.judged();
    const auto links = monitor::place(judged, drawn->base, drawn->positions);
    // Without a port, it leans with the body before the tool.
    const std::size_t before_tool =
        judged.bodies.size() - std::min<std::size_t>(2, judged.bodies.size());
    const auto& leaning = judged.bodies[has_port ? 0 : before_tool];
    const auto& body = is_leaning ? leaning : judged.bodies.back();
    const Facing one =
        facing(on.scene, axis_of(body, links), is_leaning ? 0.5 : 1.0, is_leaning ? 0.95 : 1.0);
    if (start && one.distance >= facing_most.distance) continue;
    start = drawn;
    facing_most = one;
  }
  if (!start) {
    throw Error(
        "found no start for the instrument, 5 to 20 mm before the surface with a free shaft; is "
        "the mesh in mm?");
  }
  stroke.start = *start;

  const Instrument instrument = on.robot.make(start->base);
  ChainState state;
  instrument.chain().forward_kinematics(start->positions, state);
  const Pose home = state.flange();
  const Vec3& port = start->base.position;
  const double lever =
      is_leaning && has_port ? (home.position - port).norm() / (facing_most.at - port).norm() : 1.0;
  const double off = random.uniform(0.0, 2.0);
  const Vec3 bias = off * random.direction();
  const Tremor tremor(0.1, random);
  Pass pass;
  double last = -1.0;
  const auto of_a_pass = static_cast<std::size_t>(std::ceil(pass_lasts / speed));
  const std::size_t cycles = settings.cycles > 0 ? settings.cycles : of_a_pass;
  for (std::size_t cycle = 0; cycle < cycles; ++cycle) {
    const double time = speed * static_cast<double>(cycle) / pass_lasts;  // [passes]
    if (std::floor(time) != last) pass = draw_pass(stroke.manner, facing_most.inwards, random);
    last = std::floor(time);
    const double t = time - last;
    const double to_and_fro = lowered(t) * std::sin(2.0 * std::numbers::pi * t);
    const Vec3 way =
        lowered(t) * lever * (facing_most.distance + pass.depth) * facing_most.inwards +
        to_and_fro * pass.slide * pass.heading;
    const Mat3 turn = Eigen::AngleAxisd(to_and_fro * pass.turn, pass.axis).toRotationMatrix();
    stroke.goals.push_back(
        {home.position + way + bias + tremor.at(static_cast<double>(cycle) * cycle_seconds),
         turn * home.rotation});
  }
  return stroke;
}

}  // namespace keepout::app
