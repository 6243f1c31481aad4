// SPDX-License-Identifier: BSD-3-Clause
// Provokes long control cycles. For each scene, prints the most work units (Budget) and the longest
// time of any call. Each call is tried three times; the shortest counts, to exclude other load on
// the machine. Prints the table of docs/safety.md.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/random.h"
#include "keepout/fixtures/robots.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/geometry/convex_tool.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/robot/instrument_constraint.h"
#include "keepout/simd_target.h"
#include "keepout/solvers/active_set.h"

namespace keepout {
namespace {

/// Returns a watertight sphere around the origin, with 2 n (n - 1) triangles.
Surface sphere(VertexId n, double radius) {
  Surface surface;
  for (VertexId i = 0; i <= n; ++i) {
    const double polar = std::numbers::pi * i / n;
    const double across = i % n == 0 ? 0.0 : radius * std::sin(polar);
    for (VertexId j = 0; j < n; ++j) {
      const double angle = 2.0 * std::numbers::pi * j / n;
      surface.vertices.emplace_back(across * std::cos(angle), across * std::sin(angle),
                                    radius * std::cos(polar));
    }
  }
  for (VertexId i = 0; i < n; ++i) {
    for (VertexId j = 0; j < n; ++j) {
      const VertexId a = i * n + j, b = i * n + (j + 1) % n;
      if (i > 0) surface.triangles.push_back({a, a + n, b});
      if (i + 1 < n) surface.triangles.push_back({b, a + n, b + n});
    }
  }
  return weld(std::move(surface));
}

/// Returns intersecting triangles in all directions, unlike any anatomy.
Surface soup(std::size_t triangles, double size) {
  Surface surface;
  Random random(5);
  for (VertexId t = 0; t < triangles; ++t) {
    const Vec3 middle = 10.0 * random.uniform() * random.direction();
    for (int c = 0; c < 3; ++c) surface.vertices.push_back(middle + size * random.direction());
    surface.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return surface;
}

/// Returns many copies of one triangle.
Surface copies(std::size_t triangles) {
  Surface surface{{{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}}, {}};
  surface.triangles.assign(triangles, {0, 1, 2});
  return surface;
}

struct Scene {
  std::string name;
  Surface surface;
  MotionConstraintSettings settings = {.options = {.radius = 5.0, .margin = 1.0}};
  double near = 1.0;  // the farthest tip from the middle [length]
  Vec3 middle = Vec3::Zero();
  bool with_joints = false;
  bool with_guides = false;
};

/// Returns sixteen balls around a place, for a point of a chain or a tip; some do not contain it.
std::vector<Guide> balls_about(const Vec3& place, const std::optional<LinkPoint>& point = {}) {
  std::vector<Guide> guides;
  for (std::size_t g = 0; g < Guide::most; ++g) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(g) / Guide::most;
    const Vec3 beside(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.3);
    const double radius = g % 3 == 0 ? 2.04 : 2.03;
    const Region ball = Region::ball(place + beside, radius);
    guides.push_back(point ? Guide::point("ball", *point, ball) : Guide::point("ball", ball));
  }
  return guides;
}

std::vector<Scene> scenes() {
  const auto at_tip_of_cone = [](std::string name, VertexId faces, double slope) {
    return Scene{.name = std::move(name),
                 .surface = make_cone(faces, slope),
                 .near = 1.5,
                 .middle = {0, 0, 1}};
  };
  std::vector<Scene> all;
  for (const VertexId faces : {400u, 4'000u, 20'000u, 200'000u}) {
    for (const double slope : {0.1, 1.0, 5.0}) {
      char name[64];
      std::snprintf(name, sizeof name, "tip of a cone, %u faces, slope %g", unsigned{faces}, slope);
      all.push_back(at_tip_of_cone(name, faces, slope));
    }
  }
  all.push_back(at_tip_of_cone("the same, 7 joints", 4'000, 1.0));
  all.back().settings.options.damping = 1e-6;
  all.back().with_joints = true;
  all.push_back(at_tip_of_cone("the same, 65,536 nodes, 1,000 refinements", 4'000, 1.0));
  all.back().settings.options.refinements = 1'000;
  all.back().settings.options.nodes = 65'536;
  for (const VertexId faces : {400u, 4'000u}) {
    Scene guided = at_tip_of_cone(std::to_string(faces) + " faces, 16 round guides", faces, 1.0);
    guided.near = 1.0;
    guided.with_guides = true;
    all.push_back(guided);
    guided.name = "the same, 7 joints";
    guided.settings.options.damping = 1e-6;
    guided.with_joints = true;
    all.push_back(guided);
  }
  const auto add = [&](const char* name, Surface surface, const StepOptions& options, double near) {
    all.push_back({name, std::move(surface), {.options = options}, near});
  };
  add("center of a sphere of 1 M triangles", sphere(700, 50.0), {}, 1e-3);
  add("the same of 2 M, about the center", sphere(1'000, 60.0), {}, 0.5);
  add("the same, margin as far as the wall", sphere(700, 50.0), {.radius = 5.0, .margin = 49.0},
      3.0);
  add("the same, distances always", sphere(700, 50.0), {.distances = Distances::always}, 1e-3);
  const StepOptions close{.radius = 5.0, .margin = 0.01};
  add("200,000 triangles crossing each other", soup(200'000, 3.0), close, 10.0);
  add("2 M small ones", soup(2'000'000, 0.02), close, 10.0);
  add("100,000 times the same triangle", copies(100'000), {}, 3.0);
  std::vector<Vec3> many_points;
  Random random(9);
  while (many_points.size() < ConvexTool::most_points) {
    many_points.push_back(0.8 * random.direction());
  }
  const auto add_tools = [&](const std::string& name, const Surface& surface, double near) {
    const auto add_tool = [&](const char* text, const ConvexTool& tool) {
      all.push_back({name + ", " + text,
                     surface,
                     {.options = {.radius = 5.0, .margin = 0.2}},
                     near,
                     {0, 0, 1}});
      all.back().settings.tool = tool;
    };
    add_tool("a capsule", ConvexTool::capsule({0, 0, 0}, {0.5, 0.3, 3.0}, 0.8));
    add_tool("a box", ConvexTool::box({{-0.8, -0.8, -0.8}, {0.8, 0.8, 2.0}}));
    add_tool("a hull of 64 points", ConvexTool::hull(many_points));
  };
  for (const VertexId faces : {400u, 4'000u, 20'000u}) {
    add_tools("tip of a cone, " + std::to_string(faces) + " faces", make_cone(faces, 1.0), 1.5);
  }
  add_tools("200,000 triangles crossing each other", soup(200'000, 3.0), 10.0);
  add_tools("2 M small ones", soup(2'000'000, 0.02), 10.0);
  for (const Shape& shape : shapes()) {
    const Mesh mesh(shape.make());
    const double size = mesh.bounds().size().norm();
    all.push_back({std::string(shape.name),
                   shape.make(),
                   {.options = {.radius = 0.2 * size, .margin = 0.02 * size}},
                   0.5 * size,
                   mesh.bounds().center()});
  }
  return all;
}

struct Longest {
  std::size_t work_units = 0;
  double us = 0.0;
  std::map<std::string, int> statuses;
};

using Call = std::function<std::string_view()>;

/// Takes the shortest of three tries into account. Guard: MotionConstraint or InstrumentConstraint.
template <class Guard>
void measure(Guard& guard, const Call& call, Longest& longest) {
  double least = 1e300;
  for (int attempt = 0; attempt < 3; ++attempt) {
    guard.forget();
    const auto begin = std::chrono::steady_clock::now();
    const std::string_view status = call();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
    least = std::min(least, took.count());
    if (attempt == 0) ++longest.statuses[std::string(status)];
  }
  longest.work_units = std::max(longest.work_units, guard.work_units());
  longest.us = std::max(longest.us, least);
}

void add(const Longest& one, Longest& all) {
  all.work_units = std::max(all.work_units, one.work_units);
  all.us = std::max(all.us, one.us);
  for (const auto& [status, count] : one.statuses) all.statuses[status] += count;
}

void print(const std::string& name, const Longest& steps, const Longest& polytopes) {
  const auto print_one = [](const Longest& one) {
    if (one.statuses.empty()) return std::printf(" - | - |");
    return std::printf(" %zu | %.0f |", one.work_units, one.us);
  };
  std::printf("| %s |", name.c_str());
  print_one(steps);
  print_one(polytopes);
  for (const auto& [status, count] : steps.statuses) std::printf(" %s %d", status.c_str(), count);
  std::printf(" |\n");
  std::fflush(stdout);
}

void measure(const Scene& scene, Longest& of_steps, Longest& of_polytopes) {
  const auto mesh = std::make_shared<const Mesh>(scene.surface);
  MotionConstraint guard = make_motion_constraint(mesh, scene.settings);
  Random random(1);
  Longest steps, polytopes;
  Eigen::Matrix<double, 3, 7> jacobian;
  for (int trial = 0; trial < 150; ++trial) {
    // Close to the middle, and far from it.
    const double off = scene.near * std::pow(10.0, random.uniform(-6.0, 0.0));
    const Vec3 tip = scene.middle + off * random.direction();
    const Vec3 desired = scene.settings.options.radius * random.uniform() *
                         (trial % 2 == 0 ? random.direction() : Vec3(0.0, 0.0, -1.0));
    Motion motion{.tip = tip, .desired = desired};
    if (scene.with_joints) {
      for (int c = 0; c < 7; ++c) jacobian.col(c) = random.direction();
      motion.jacobian = jacobian;
    }
    if (scene.with_guides) guard.set_guides(balls_about(tip));
    measure(
        guard, [&] { return name(guard.step(motion).status); }, steps);
    measure(
        guard, [&] { return name(guard.free_polytope(tip, desired.norm()).status); }, polytopes);
  }
  print(scene.name, steps, polytopes);
  add(steps, of_steps);
  add(polytopes, of_polytopes);
}

/// A psm among meshes, which start where its joints are at `straight`.
struct InstrumentScene {
  std::string name;
  std::vector<Surface> surfaces;
  InstrumentOptions options = {};
  double longest = 5.0;  // of the desired displacements [length]
  double speed = 0.0;    // of the meshes [length/s]
  bool with_guides = false;
};

constexpr std::array<double, 6> straight{0.1, -0.1, 120.0, 0.2, 0.0, 0.0};

/// Returns a triangulated tube around a segment, rough by `rough`, open at both ends. [length]
void add_tube(const Vec3& from, const Vec3& to, double radius, double edge, double rough,
              Random& random, Surface& surface) {
  const Vec3 along = (to - from).normalized();
  const Vec3 u = along.unitOrthogonal(), v = along.cross(u);
  const auto around = static_cast<VertexId>(std::ceil(2.0 * std::numbers::pi * radius / edge));
  const auto rings = static_cast<VertexId>(std::ceil((to - from).norm() / edge)) + 1;
  const auto first = static_cast<VertexId>(surface.vertices.size());
  for (VertexId i = 0; i < rings; ++i) {
    for (VertexId j = 0; j < around; ++j) {
      const double angle = 2.0 * std::numbers::pi * j / around;
      const double r = radius + rough * random.uniform();
      surface.vertices.push_back(from + edge * i * along +
                                 r * (std::cos(angle) * u + std::sin(angle) * v));
    }
  }
  for (VertexId i = 0; i + 1 < rings; ++i) {
    for (VertexId j = 0; j < around; ++j) {
      const VertexId a = first + i * around + j, b = first + i * around + (j + 1) % around;
      surface.triangles.push_back({a, b, a + around});
      surface.triangles.push_back({b, b + around, a + around});
    }
  }
}

/// Returns tubes around the bodies of the psm, `gap` from their surfaces, along `length` of the
/// shaft. [length]
Surface sheath(double edge, double gap, double rough, double length) {
  const Instrument instrument = psm();
  ChainState state;
  instrument.chain().forward_kinematics(straight, state);
  Random random(3);
  Surface surface;
  for (std::size_t b = 0; b < instrument.bodies().size(); ++b) {
    const Body& body = instrument.bodies()[b];
    const Vec3 to = state.at(body.points.back().link, body.points.back().position);
    const Vec3 from = state.at(body.points.front().link, body.points.front().position);
    // Starts beyond the end of the thicker body before it.
    const double part = b == 0 ? length : (to - from).norm() - instrument.bodies()[b - 1].radius;
    if (!(part > 0.0)) continue;
    add_tube(to - part * (to - from).normalized(), to, body.radius + gap, edge, rough, random,
             surface);
  }
  return surface;
}

/// Returns a surface moved so that its origin is `ahead` of the tip of the psm. [length]
Surface ahead_of_tip(Surface surface, double ahead) {
  ChainState state;
  const Instrument instrument = psm();
  instrument.chain().forward_kinematics(straight, state);
  const Body& jaw = instrument.bodies().back();
  const Vec3 tip = state.at(jaw.points.back().link, jaw.points.back().position);
  const Vec3 back = (state.at(jaw.points.front().link, jaw.points.front().position) - tip);
  const Mat3 turn = rotation_between(Vec3::UnitZ(), back).toRotationMatrix();
  for (Vec3& vertex : surface.vertices) {
    vertex = tip - ahead * back.normalized() + turn * vertex;
  }
  return surface;
}

std::vector<InstrumentScene> instrument_scenes() {
  std::vector<InstrumentScene> all;
  const auto add = [&](std::string name, Surface surface, const InstrumentOptions& options = {}) {
    all.push_back({"psm, " + std::move(name), {std::move(surface)}, options});
  };
  constexpr double gap = 0.25, rough = 0.05;
  add("sheath of edges of 2 mm", sheath(2.0, gap, rough, 60.0));
  add("of 0.7 mm", sheath(0.7, gap, rough, 60.0));
  add("of 0.35 mm", sheath(0.35, gap, rough, 60.0));
  add("of 0.35 mm, short", sheath(0.35, gap, rough, 20.0));
  add("of 0.2 mm, short", sheath(0.2, gap, rough, 10.0));
  add("of 0.1 mm, short", sheath(0.1, gap, rough, 4.0));
  add("of 0.7 mm, too close", sheath(0.7, 0.1, rough, 60.0));
  add("of 0.35 mm, too close", sheath(0.35, 0.1, rough, 20.0));
  add("of 0.7 mm, margin 2 mm", sheath(0.7, 2.05, rough, 60.0), {.margin = 2.0});
  add("of 0.7 mm, slowed down within 5 mm", sheath(0.7, gap, rough, 60.0), {.slowing_within = 5.0});
  add("of 0.7 mm, 100 refinements", sheath(0.7, gap, rough, 60.0), {.refinements = 100});
  all.push_back({"psm, of 0.7 mm, motions of 0.5 mm", {sheath(0.7, gap, rough, 60.0)}, {}, 0.5});
  all.push_back({"psm, of 0.7 mm, 16 guides", {sheath(0.7, gap, rough, 60.0)}});
  all.back().with_guides = true;
  for (const double edge : {2.0, 1.0, 0.5}) {
    all.push_back({"psm, 8 sheaths of " + std::to_string(edge).substr(0, 3) + " mm, moving",
                   std::vector<Surface>(8, sheath(edge, 0.5, rough, 30.0)),
                   {},
                   0.5,
                   100.0});
  }
  for (const VertexId faces : {4'000u, 20'000u}) {
    add("tip of a cone, " + std::to_string(faces) + " faces",
        ahead_of_tip(make_cone(faces, 1.0), 1.25));
  }
  add("200,000 triangles crossing each other", ahead_of_tip(soup(200'000, 3.0), 0.0));
  add("2 M small ones", ahead_of_tip(soup(2'000'000, 0.02), 0.0));
  add("10,000 times the same triangle", ahead_of_tip(copies(10'000), 1.25));
  return all;
}

void measure(const InstrumentScene& scene, Longest& of_steps) {
  InstrumentOptions options = scene.options;
  options.period = 0.1;
  InstrumentConstraint guard(psm(), std::make_unique<ActiveSet>(), options);
  for (const Surface& surface : scene.surfaces) {
    const auto mesh = std::make_shared<const Mesh>(surface);
    guard.add_mesh(mesh, std::make_shared<const WideBvh>(mesh));
  }
  Random random(1);
  Longest steps;
  for (int trial = 0; trial < 150; ++trial) {
    std::array<double, 6> q = straight;
    for (double& position : q) position += std::pow(10.0, random.uniform(-8.0, -2.0));
    if (scene.with_guides) {
      ChainState state;
      guard.instrument().chain().forward_kinematics(q, state);
      const LinkPoint tip = guard.instrument().bodies().back().points.back();
      guard.set_guides(balls_about(state.at(tip.link, tip.position), tip));
    }
    const double length = scene.longest * random.uniform();
    const Twist desired{.linear = length * random.direction(),
                        .angular = 0.04 * length * random.direction()};
    Twist velocity{.linear = scene.speed * random.direction(),
                   .angular = 0.01 * scene.speed * random.direction()};
    measure(
        guard,
        [&] {
          for (std::size_t m = 0; scene.speed > 0.0 && m < guard.mesh_count(); ++m) {
            guard.place(m, {}, (m % 2 == 0) == (trial % 2 == 0) ? velocity : Twist{});
          }
          return name(guard.step(q, desired).status);
        },
        steps);
  }
  print(scene.name, steps, {});
  add(steps, of_steps);
}

}  // namespace
}  // namespace keepout

int main() try {
  using namespace keepout;
  std::printf("SIMD target %s; stated: %zu work units\n\n", std::string(simd_target()).c_str(),
              Capacity::work_units_of_traversals);
  std::printf(
      "| scene | work of a step | µs | work of a polytope | µs | how steps ended |\n"
      "|---|--:|--:|--:|--:|---|\n");
  Longest steps, polytopes;
  for (const Scene& scene : scenes()) measure(scene, steps, polytopes);
  for (const InstrumentScene& scene : instrument_scenes()) measure(scene, steps);
  print("**all**", steps, polytopes);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "longest_cycle: %s\n", error.what());
  return 1;
}
