// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/setup.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "keepout/error.h"
#include "operators/attacker.h"

namespace keepout::app {
namespace {

// The greatest motion of meshes at speed 1, in a cycle.
constexpr double fastest_mesh = 0.1;         // [mm]
constexpr double fastest_mesh_turn = 0.002;  // [rad]

RobotUnderTest robot_of(const Scenario& scenario, const RobotUnderTest* named, Random& random) {
  if (scenario.has_stuck_bodies) return robot_with_stuck_bodies(random);
  if (scenario.attacked == Attacked::tip) return sliding_ball(random);
  if (scenario.attacked == Attacked::convex_tool) return sliding_hull(random);
  RobotUnderTest robot = named != nullptr ? *named : drawn_robot(random);
  if (scenario.has_blade) robot = with_blade(robot, random);
  if (!scenario.has_velocity_limits) robot = without_velocity_limits(robot);
  return robot;
}

Mat3 drawn_rotation(Random& random) {
  return Eigen::AngleAxisd(random.uniform(0.0, std::numbers::pi), random.direction())
      .toRotationMatrix();
}

Pose inverse(const Pose& pose) {
  return {-(pose.rotation.transpose() * pose.position), pose.rotation.transpose()};
}

/// Sets a swinging motion of the mesh about a place.
void set_swinging(MeshMotion& motion, double speed, const Vec3& center, Random& random) {
  motion.along = random.direction();
  motion.about = random.direction();
  motion.center = center;
  motion.cycles = random.uniform(30.0, 300.0);
  // A sine is fastest at its zero.
  const double longest = motion.cycles / (0.5 * std::numbers::pi);
  motion.way = std::min(random.uniform() * speed * fastest_mesh * longest, 10.0);
  motion.turn = std::min(random.uniform() * speed * fastest_mesh_turn * longest, 0.3);
}

/// Puts another mesh beside the tool, clear of all bodies. Returns false if many tries find no
/// place.
bool put_beside(SetupMesh& mesh, const monitor::JudgedRobot& robot, const RobotStart& start,
                const Vec3& tool, double margin, Random& random) {
  const Mesh& surface = *mesh.scene->mesh();
  for (int i = 0; i < 100; ++i) {
    mesh.motion.first.rotation = drawn_rotation(random);
    const Vec3 vertex = surface.vertex(static_cast<VertexId>(random.below(surface.vertex_count())));
    mesh.motion.first.position =
        tool + random.uniform(3.0, 20.0) * random.direction() - mesh.motion.first.rotation * vertex;
    const RobotStart seen{inverse(mesh.motion.first) * start.base, start.positions};
    if (clearance(robot, seen, *mesh.scene, margin) >= margin) return true;
  }
  return false;
}

using Links = std::vector<monitor::LinkFrame>;

/// Draws a region around a place. The place is in it or, in one of four cases, slightly outside.
void draw_region(oracle::JudgedGuide& guide, const Vec3& place, Random& random) {
  using Region = oracle::JudgedGuide::Region;
  guide.region = static_cast<Region>(random.below(4));
  guide.direction = random.direction();
  guide.radius = std::pow(10.0, random.uniform(-1.0, 1.0));
  const double out = random.uniform() < 0.25 ? random.uniform(0.0, 0.5) : 0.0;
  const double depth = out > 0.0 ? guide.radius + out : random.uniform() * guide.radius;
  Vec3 off = random.direction();
  if (guide.region == Region::tube) {
    off = (off - off.dot(guide.direction) * guide.direction).normalized();
  }
  if (guide.region == Region::slab) off = guide.direction;
  if (guide.region == Region::half_space) {
    guide.origin = place + (out > 0.0 ? out : -depth) * guide.direction;
    guide.radius = 0.0;
    return;
  }
  guide.origin = place + depth * off;
}

oracle::JudgedGuide draw_guide(const monitor::JudgedRobot& robot, const Links& links,
                               bool is_of_tip, Random& random) {
  using Kind = oracle::JudgedGuide::Kind;
  oracle::JudgedGuide guide{.band = std::pow(10.0, random.uniform(-3.0, -1.5))};
  const monitor::JudgedBody& body = robot.bodies[random.below(robot.bodies.size())];
  const double kind = random.uniform();
  if (is_of_tip || kind < 0.5) {
    // A point of the base would not move.
    const monitor::JudgedPoint& of_body =
        body.points.front().link > 0 ? body.points.front() : body.points.back();
    guide.first = is_of_tip ? robot.bodies.back().points.back() : of_body;
    draw_region(guide, links[static_cast<std::size_t>(guide.first.link)].at(guide.first.position),
                random);
  } else if (kind < 0.75) {
    guide.kind = Kind::axis;
    guide.first = {static_cast<int>(robot.table.size()), random.direction()};
    const monitor::LinkFrame& link = links.back();
    const Vec3 now = link.at(guide.first.position) - link.at(Vec3::Zero());
    const double angle = random.uniform(0.02, 0.5);
    const bool is_out = random.uniform() < 0.25;
    const double off = is_out ? angle + random.uniform(0.0, 0.05) : angle * random.uniform();
    const Vec3 across = random.direction().cross(now).normalized();
    guide.origin = (std::cos(off) * now + std::sin(off) * across).normalized();
    guide.radius = 2.0 * std::sin(0.5 * angle);
    guide.band *= 0.1;
  } else {
    guide.kind = Kind::remote_center;
    guide.first = {0, random.uniform(10.0, 80.0) * random.direction()};
    guide.second = robot.bodies.back().points.back();
    const Vec3 from = links[0].at(guide.first.position);
    const Vec3 to = links[static_cast<std::size_t>(guide.second.link)].at(guide.second.position);
    guide.region = oracle::JudgedGuide::Region::ball;
    guide.radius = random.uniform(0.1, 3.0);
    guide.origin = from + random.uniform(0.2, 0.8) * (to - from) +
                   random.uniform(0.0, 1.1) * guide.radius * random.direction();
  }
  return guide;
}

}  // namespace

std::span<const Scenario> scenarios() {
  static const std::array<Scenario, 12> all{{
      {.name = "approach", .description = "driven to the surface, and around on it"},
      {.name = "raised",
       .description = "approach, while the margin is raised every other 500 cycles",
       .raises_margin = true},
      {.name = "overlapping",
       .description = "begins with the surface inside a body, by up to half its radius",
       .begin = Begin::overlapping},
      {.name = "wedged",
       .description = "begins between two walls, and the margin is raised at once",
       .begin = Begin::wedged,
       .raises_margin = true},
      {.name = "guides",
       .description =
           "one to three guides of points, axes and shafts, which may contradict each other",
       .has_guides = true},
      {.name = "blade",
       .description = "a convex blade of 3 to 8 points on the last link",
       .has_blade = true},
      {.name = "moving", .description = "the mesh swings and turns", .moves = true},
      {.name = "meshes",
       .description = "up to three meshes that swing and turn, each with its own margin",
       .meshes = 3,
       .moves = true},
      {.name = "stuck",
       .description = "a mesh approaches; two bodies cannot retreat, and the tool must",
       .moves = true,
       .has_stuck_bodies = true,
       .carrier = Carrier::slides},
      {.name = "unlimited",
       .description = "joints without velocity limits",
       .has_velocity_limits = false},
      {.name = "tip_guides",
       .description = "a ball at a tip, with one to three guides",
       .has_guides = true,
       .attacked = Attacked::tip,
       .carrier = Carrier::slides},
      {.name = "convex_tool",
       .description = "a convex tool that does not turn",
       .attacked = Attacked::convex_tool,
       .carrier = Carrier::slides},
  }};
  return all;
}

const Scenario& scenario_named(const std::string& name) {
  const auto all = scenarios();
  const auto found = std::ranges::find(all, name, &Scenario::name);
  if (found == all.end()) throw Error("there is no scenario '" + name + "'");
  return *found;
}

Pose MeshMotion::at(double cycle) const {
  if (is_still()) return first;
  double share = std::sin(0.5 * std::numbers::pi * cycle / cycles);
  if (comes_on) {
    const double phase = std::fmod(cycle / cycles, 2.0);
    share = phase < 1.0 ? phase : 2.0 - phase;
  }
  const Mat3 rotation = Eigen::AngleAxisd(share * turn, about).toRotationMatrix();
  return Pose{center + share * way * along - rotation * center, rotation} * first;
}

std::optional<RobotSetup> draw_setup(
    const Scenario& scenario, const RobotUnderTest* named, double speed, Random& random,
    const std::function<std::shared_ptr<Scene>(Random&)>& draw_mesh,
    const std::function<InstrumentOptions(const Chain&)>& options) {
  RobotSetup setup{.scenario = &scenario,
                   .robot = robot_of(scenario, named, random),
                   .start = {},
                   .meshes = {{draw_mesh(random)}},
                   .speed = speed};
  setup.options = options(setup.robot.make({}).chain());
  const bool is_of_slides = scenario.carrier == Carrier::slides;
  // Prismatic joints cannot rotate the flange.
  if (is_of_slides || (named == nullptr && random.uniform() < 0.5)) {
    setup.options.orientation_weight = 0.0;
  }
  if (scenario.attacked != Attacked::instrument) setup.options.damping = 0.0;
  // Slow motions start nearer, so that they come into contact.
  constexpr double cycles_to_contact = 500.0;
  const double ahead = std::min(is_of_slides ? 4.0 : 20.0,
                                setup.options.margin + setup.robot.judged().bodies.back().radius +
                                    cycles_to_contact * speed * fastest_way);
  const auto start = find_start(*setup.meshes[0].scene, setup.robot, scenario.begin,
                                setup.options.margin, random, ahead);
  if (!start) return std::nullopt;
  setup.start = *start;
  const monitor::JudgedRobot judged = setup.robot.judged();
  if (scenario.moves) {
    // A random frame of the world, so that no two frames are equal.
    const Pose world{random.uniform(0.0, 50.0) * random.direction(), drawn_rotation(random)};
    setup.meshes[0].motion.first = world;
    setup.start.base = world * setup.start.base;
  }
  const Links links = monitor::place(judged, setup.start.base, setup.start.positions);
  const Vec3 tool = axis_of(judged.bodies.back(), links).to;
  const std::size_t meshes = scenario.meshes > 1 ? 2 + random.below(scenario.meshes - 1) : 1;
  for (std::size_t m = 1; m < meshes; ++m) {
    SetupMesh mesh{
        .scene = draw_mesh(random),
        .margin = random.uniform() < 0.5 ? 0.0 : random.uniform(0.5, 5.0) * setup.options.margin};
    if (!put_beside(mesh, judged, setup.start, tool, std::max(mesh.margin, setup.options.margin),
                    random)) {
      return std::nullopt;
    }
    setup.meshes.push_back(mesh);
  }
  if (scenario.has_stuck_bodies) {
    MeshMotion& motion = setup.meshes[0].motion;
    const Pose seen = inverse(motion.first);
    const Hit hit = setup.meshes[0].scene->nearest(seen * tool);
    motion.along = motion.first.rotation * -hit.closest.offset.normalized();
    motion.way = 20.0;
    // At most half of what the joints can do in a cycle.
    motion.cycles = motion.way / (speed * random.uniform(0.01, 1.0));
    motion.comes_on = true;
    setup.must_keep = judged.bodies.size() - 1;
  } else if (scenario.moves) {
    for (std::size_t m = 0; m < setup.meshes.size(); ++m) {
      if (m > 0 && random.uniform() < 0.25) continue;  // this mesh does not move
      set_swinging(setup.meshes[m].motion, speed, tool, random);
    }
  }
  if (scenario.has_guides) {
    for (std::size_t g = 0, count = 1 + random.below(3); g < count; ++g) {
      setup.guides.push_back(draw_guide(judged, links, scenario.attacked == Attacked::tip, random));
    }
  }
  return setup;
}

}  // namespace keepout::app
