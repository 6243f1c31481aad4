// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/start.h"

#include <algorithm>
#include <numbers>

#include "keepout/fixtures/robots.h"
#include "keepout/oracle/instrument_oracle.h"
#include "verify/setup.h"

namespace keepout::app {
namespace {

constexpr int tries = 4000;

/// The place of the tip, and the direction from which the instrument comes.
struct Target {
  Vec3 tip;
  Vec3 way;  // unit, along the tool
};

Target before_surface(const SurfacePoint& on, double ahead, Random& random) {
  const Vec3 way = -(on.normal + 0.7 * random.uniform() * random.direction()).normalized();
  return {on.point - random.uniform(0.25, 1.0) * ahead * way, way};
}

/// Returns a place on the normal that is equally far from another wall. A tool that keeps `least`
/// from both walls has at most a millimeter of free space there.
std::optional<Target> between_walls(Scene& scene, const SurfacePoint& on, double least,
                                    Random& random) {
  for (double way = least; way < least + 1.2; way += 0.1) {
    const Vec3 center = on.point + way * on.normal;
    const double distance = scene.nearest(center, way).closest.distance;
    if (distance > 0.95 * way) continue;  // the nearest wall is still the first one
    if (distance < least) break;
    const Vec3 along = random.direction().cross(on.normal).normalized();
    return Target{center + random.uniform(0.0, 8.0) * along, along};
  }
  return std::nullopt;
}

}  // namespace

double clearance(const monitor::JudgedRobot& robot, const RobotStart& start, const Scene& scene,
                 double reach) {
  oracle::InstrumentOracle judge(scene.tree(), robot, start.base);
  judge.move_to(start.positions);
  return judge.clearance(reach);
}

std::optional<RobotStart> find_start(Scene& scene, const RobotUnderTest& robot, Begin begin,
                                     double margin, Random& random, double ahead) {
  const monitor::JudgedRobot judged = robot.judged();
  const double tool = judged.bodies.back().radius;
  // The tip starts at most `ahead` from the surface.
  if (begin != Begin::wedged && margin + tool > ahead) return std::nullopt;
  for (int i = 0; i < tries; ++i) {
    SurfacePoint on = on_face(*scene.mesh(), random);
    // A surface without sides is approached from either side.
    if (!scene.has_sides() && random.uniform() < 0.5) on.normal = -on.normal;
    const std::optional<Target> target = begin == Begin::wedged
                                             ? between_walls(scene, on, tool + margin, random)
                                             : before_surface(on, ahead, random);
    if (!target) continue;
    RobotStart start;
    for (const auto& [low, high] : robot.starts) {
      start.positions.push_back(random.uniform(low, high));
    }
    // The base follows from the place of the tool, with a random rotation about the tool.
    const monitor::Segment axis =
        axis_of(judged.bodies.back(), monitor::place(judged, {}, start.positions));
    const bool has_length = axis.from != axis.to;
    const Vec3 along = has_length ? Vec3(axis.to - axis.from) : random.direction();
    const double roll = random.uniform(-std::numbers::pi, std::numbers::pi);
    start.base.rotation =
        (Eigen::AngleAxisd(roll, target->way) * rotation_between(along, target->way))
            .toRotationMatrix();
    start.base.position = target->tip - start.base.rotation * axis.to;
    if (clearance(judged, start, scene, margin) < margin) continue;
    if (begin != Begin::overlapping) return start;
    // Advance until the tool, or a thicker body, overlaps enough.
    const double wanted = -random.uniform(0.05, 0.45) * tool;
    double overlap = 0.0;
    for (double gone = 0.0; gone < 40.0 && overlap > wanted; gone += 0.05) {
      start.base.position += 0.05 * target->way;
      overlap = clearance(judged, start, scene, 0.0);
    }
    if (overlap < wanted && overlap > -0.5 * tool) return start;
  }
  return std::nullopt;
}

}  // namespace keepout::app
