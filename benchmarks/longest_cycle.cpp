// SPDX-License-Identifier: BSD-3-Clause
// Provokes long control cycles. For each scene, prints the most work units (Budget) and the longest
// time of any call. Each call is tried three times; the shortest counts, to exclude other load on
// the machine. Prints the table of docs/safety.md.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/random.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/simd_target.h"

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

/// Returns sixteen balls around a place; some do not contain it.
std::vector<Guide> balls_about(const Vec3& place) {
  std::vector<Guide> guides;
  for (std::size_t g = 0; g < Guide::most; ++g) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(g) / Guide::most;
    const Vec3 beside(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.3);
    const double radius = g % 3 == 0 ? 2.04 : 2.03;
    guides.push_back(Guide::point("ball", Region::ball(place + beside, radius)));
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

/// Takes the shortest of three tries into account.
void measure(MotionConstraint& guard, const Call& call, Longest& longest) {
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

void print(const std::string& name, const Longest& steps, const Longest& polytopes) {
  std::printf("| %s | %zu | %.0f | %zu | %.0f |", name.c_str(), steps.work_units, steps.us,
              polytopes.work_units, polytopes.us);
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
  for (const auto& [one, all] : {std::pair(&steps, &of_steps), {&polytopes, &of_polytopes}}) {
    all->work_units = std::max(all->work_units, one->work_units);
    all->us = std::max(all->us, one->us);
    for (const auto& [status, count] : one->statuses) all->statuses[status] += count;
  }
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
  print("**all**", steps, polytopes);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "longest_cycle: %s\n", error.what());
  return 1;
}
