// SPDX-License-Identifier: BSD-3-Clause
//
// What a web page calls of keepout: anatomy is made of a surface, a file or a shape, and guards of
// anatomy, with the parts and in the way that the command has them. Nothing is thrown out of here:
// what cannot be made is null, and keepout_failure says why. Texts stay valid until the next call
// that returns one; all are UTF-8.
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomy.h"
#include "json_text.h"
#include "keepout/control/haptic_force.h"
#include "keepout/error.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/counterexamples.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/mesh/doctor.h"
#include "keepout/mesh/load_mesh.h"
#include "shared/clip.h"
#include "shared/findings.h"

namespace {

using keepout::Vec3;
using keepout::web::failure;
using keepout::web::json;
using keepout::web::json_list;
using keepout::web::made;

std::string text;  // the last one that was handed out

/// Null, with a message, where it throws.
template <class Make>
const char* made_text(const Make& make) noexcept {
  try {
    text = make();
    return text.c_str();
  } catch (const std::exception& error) {
    failure = error.what();
  }
  return nullptr;
}

/// A literal of the library's, which ends with a zero.
const char* literal(std::string_view words) noexcept { return words.data(); }

}  // namespace

/// What a control cycle came to, as it lies in memory. Valid until the guard's next call.
struct Cycle {
  double tip[3];     // of the tool, after the cycle [mm]
  double motion[3];  // of the tool in it [mm]
  double force[3];   // of the spring between hand and tool, on the hand [N]
  double distance;   // from the tool before the cycle to the nearest triangle; NaN: not known [mm]
  std::uint32_t status;     // keepout_status_name has its name
  std::uint32_t triangles;  // that it rests on
  std::uint32_t plane_count;
  std::uint32_t active_count;
  const keepout::HalfSpace* planes;  // (plane_count), from the tip before the cycle
  const std::uint32_t* active;       // (active_count): the planes that hold the motion back
};
static_assert(sizeof(void*) == 4 && sizeof(Cycle) == 104);
static_assert(offsetof(Cycle, motion) == 24 && offsetof(Cycle, force) == 48);
static_assert(offsetof(Cycle, distance) == 72 && offsetof(Cycle, status) == 80);
static_assert(offsetof(Cycle, triangles) == 84 && offsetof(Cycle, plane_count) == 88);
static_assert(offsetof(Cycle, active_count) == 92 && offsetof(Cycle, planes) == 96);
static_assert(offsetof(Cycle, active) == 100 && sizeof(keepout::HalfSpace) == 40);
static_assert(offsetof(keepout::HalfSpace, offset) == 24);
static_assert(offsetof(keepout::HalfSpace, source) == 32);

/// A tool, the hand that leads it, and what keeps it out, if anything does.
struct Guard {
  /// One step from a tip. Leaves the tool where it led to.
  const Cycle* step(const keepout::Motion& motion) noexcept {
    keepout::Step step{.status = keepout::Status::free, .motion = motion.desired};
    if (constraint) step = constraint->step(motion);
    tip = motion.tip + step.motion;
    cycle.distance = step.distance.value_or(std::numeric_limits<double>::quiet_NaN());
    cycle.status = static_cast<std::uint32_t>(step.status);
    cycle.triangles = static_cast<std::uint32_t>(step.triangles);
    cycle.plane_count = static_cast<std::uint32_t>(step.planes.size());
    cycle.active_count = static_cast<std::uint32_t>(step.active.size());
    cycle.planes = step.planes.data();
    cycle.active = step.active.data();
    Eigen::Map<Vec3>(cycle.tip) = tip;
    Eigen::Map<Vec3>(cycle.motion) = step.motion;
    return &cycle;
  }

  /// The spring's part of what a hand there feels.
  void pull(const Vec3& hand) noexcept {
    const Vec3 stretch = tip - hand;
    const double length = stretch.norm();
    Eigen::Map<Vec3> force(cycle.force);
    force.setZero();
    if (constraint && length > 0.0) force = stretch * (spring.spring_force(length) / length);
  }

  std::optional<keepout::MotionConstraint> constraint;  // none: the tool goes where the hand leads
  keepout::SpringDamper spring;
  double max_step;
  Vec3 tip = Vec3::Zero();
  Cycle cycle = {};
};

extern "C" {

/// Why the last call that returned null failed, and what to do about it.
const char* keepout_failure() { return failure.c_str(); }

/// Anatomy of a surface whose equal vertices are one already: vertices (vertex_count, 3) in mm,
/// corners (triangle_count, 3). It is copied.
Anatomy* keepout_anatomy_of_surface(const double* vertices, std::uint32_t vertex_count,
                                    const std::uint32_t* corners, std::uint32_t triangle_count) {
  return made([&] {
    keepout::Surface surface;
    surface.vertices.reserve(vertex_count);
    for (std::size_t v = 0; v < vertex_count; ++v) surface.vertices.emplace_back(vertices + 3 * v);
    surface.triangles.reserve(triangle_count);
    for (std::size_t t = 0; t < triangle_count; ++t) {
      const std::uint32_t* const c = corners + 3 * t;
      surface.triangles.push_back({c[0], c[1], c[2]});
    }
    return std::make_unique<Anatomy>(std::move(surface));
  });
}

/// Anatomy of a file of the file system in memory: STL, PLY, OBJ or OFF, in mm.
Anatomy* keepout_anatomy_of_file(const char* path) {
  return made([&] {
    return std::make_unique<Anatomy>(keepout::load_mesh(path, {.check = keepout::MeshCheck::none}));
  });
}

/// Anatomy of a generated shape: keepout_shapes() has the names.
Anatomy* keepout_anatomy_of_shape(const char* name) {
  return made([&] { return std::make_unique<Anatomy>(keepout::make_shape(name)); });
}

/// Frees anatomy; guards on it may go on.
void keepout_discard_anatomy(Anatomy* anatomy) { delete anatomy; }

/// How many vertices there are.
std::uint32_t keepout_vertex_count(const Anatomy* anatomy) {
  return static_cast<std::uint32_t>(anatomy->mesh->vertex_count());
}

/// Where they are (keepout_vertex_count, 3). [mm]
const double* keepout_vertices(const Anatomy* anatomy) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return anatomy->mesh->vertices().data()->data();
}

/// How many triangles there are.
std::uint32_t keepout_triangle_count(const Anatomy* anatomy) {
  return static_cast<std::uint32_t>(anatomy->mesh->triangle_count());
}

/// The vertices of each (keepout_triangle_count, 3).
const std::uint32_t* keepout_corners(const Anatomy* anatomy) {
  static_assert(sizeof(keepout::Corners) == 3 * sizeof(std::uint32_t));
  return anatomy->mesh->triangles().data()->data();
}

/// What is to be known of the mesh, as JSON: watertight, size, the warnings of its file, and the
/// findings of `keepout inspect` but for self-intersections, the worst first. Null on failure.
const char* keepout_findings(const Anatomy* anatomy) {
  return made_text([&] {
    const keepout::MeshFindings mesh = examine(*anatomy->mesh);
    const auto findings = keepout::app::findings_of(mesh, std::nullopt);
    const auto object = [](const keepout::app::Finding& finding) {
      return R"({"key":)" + json(finding.key) + R"(,"count":)" + json(finding.count) +
             R"(,"text":)" + json(text_of(finding)) + R"(,"advice":)" + json(finding.advice) + '}';
    };
    return std::string(R"({"watertight":)") + (mesh.is_watertight() ? "true" : "false") +
           R"(,"size":)" + json_list(mesh.bounds.size()) + R"(,"warnings":)" +
           json_list(anatomy->warnings) + R"(,"findings":)" + json_list(findings, object) + '}';
  });
}

/// From a place to the nearest triangle; below 0 inside of a watertight mesh. NaN where that cannot
/// be told. [mm]
double keepout_clearance(Anatomy* anatomy, double x, double y, double z) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (!anatomy->probe) {
    // What is not led out from any depth is said to be inside: by the winding, and nothing else.
    const double size = anatomy->mesh->bounds().size().norm();
    anatomy->probe.reset(made([&] {
      return std::make_unique<keepout::MotionConstraint>(
          anatomy->guard({.options = {.radius = 1e-3 * size,
                                      .margin = 1e-6 * size,
                                      .deepest = 0.0,
                                      .distances = keepout::Distances::always}}));
    }));
    if (!anatomy->probe) return unknown;
  }
  keepout::MotionConstraint& probe = *anatomy->probe;
  probe.forget();
  const keepout::Step step = probe.step({.tip = {x, y, z}, .desired = Vec3::Zero()});
  if (!step.distance) return unknown;
  return step.status == keepout::Status::inside ? -*step.distance : *step.distance;
}

/// A tool at the origin that is kept out of anatomy by a rule, or by none: rule "none". Lengths in
/// mm, stiffness in N/mm, force in N. `max_step`: how far the tool may follow the hand in a cycle.
Guard* keepout_make_guard(Anatomy* anatomy, const char* rule, double radius, double tool_radius,
                          double margin, double max_step, double stiffness, double largest_force) {
  return made([&] {
    auto guard = std::make_unique<Guard>();
    guard->spring = {.stiffness = stiffness, .largest_force = largest_force};
    check(guard->spring);
    guard->max_step = max_step;
    if (std::string_view(rule) == "none") return guard;
    keepout::app::require_within_reach(max_step, radius);
    guard->constraint = anatomy->guard({.activation = rule,
                                        .options = {.radius = radius,
                                                    .tool_radius = tool_radius,
                                                    .margin = margin,
                                                    .distances = keepout::Distances::always}});
    return guard;
  });
}

/// Frees a guard.
void keepout_discard_guard(Guard* guard) { delete guard; }

/// Puts the tool there and forgets the past: from here on it does what `keepout replay
/// --closed-loop` does from a first line that says so.
void keepout_place(Guard* guard, double x, double y, double z) {
  guard->tip = {x, y, z};
  if (guard->constraint) guard->constraint->forget();
}

/// One control cycle towards where the hand is, as `keepout replay --closed-loop`.
const Cycle* keepout_follow(Guard* guard, double gx, double gy, double gz) {
  const Vec3 hand(gx, gy, gz);
  const Vec3 desired = keepout::app::clipped(hand - guard->tip, guard->max_step);
  const Cycle* const cycle = guard->step({.tip = guard->tip, .desired = desired});
  guard->pull(hand);
  return cycle;
}

/// One step from a tip by an increment that is desired, as `keepout replay`.
const Cycle* keepout_step(Guard* guard, double px, double py, double pz, double dx, double dy,
                          double dz) {
  const keepout::Motion motion{.tip = {px, py, pz}, .desired = {dx, dy, dz}};
  const Cycle* const cycle = guard->step(motion);
  guard->pull(motion.tip + motion.desired);
  return cycle;
}

/// The name of a status: free, limited, ...
const char* keepout_status_name(std::uint32_t status) {
  return literal(name(static_cast<keepout::Status>(status)));
}

/// Returns one line on what a status means and what to do about it. `subject`: 0 a tip, 1 an
/// instrument.
const char* keepout_status_reason(std::uint32_t status, std::uint32_t subject) {
  return literal(
      reason(static_cast<keepout::Status>(status), static_cast<keepout::Subject>(subject)));
}

/// The names of the generated shapes, as a JSON list.
const char* keepout_shapes() {
  return made_text([] {
    return json_list(keepout::shapes(),
                     [](const keepout::Shape& shape) { return json(shape.name); });
  });
}

/// The counterexamples to the paper's rule, as a JSON list of objects: name, vertices, triangles,
/// tip, desired, radius.
const char* keepout_counterexamples() {
  return made_text([] {
    const auto lists = [](const auto& rows) {
      return json_list(rows, [](const auto& row) { return json_list(row); });
    };
    return json_list(keepout::counterexamples(), [&](const keepout::Counterexample& example) {
      return R"({"name":)" + json(example.name) + R"(,"vertices":)" +
             lists(example.surface.vertices) + R"(,"triangles":)" +
             lists(example.surface.triangles) + R"(,"tip":)" + json_list(example.tip) +
             R"(,"desired":)" + json_list(example.desired) + R"(,"radius":)" +
             json(example.radius) + '}';
    });
  });
}

}  // extern "C"
