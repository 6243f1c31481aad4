// SPDX-License-Identifier: BSD-3-Clause
#include "tool.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "keepout/control/haptic_force.h"
#include "keepout/error.h"
#include "keepout/factory/guide_text.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/fixtures/robots.h"
#include "keepout/index/query.h"
#include "keepout/robot/instrument_constraint.h"
#include "shared/clip.h"

namespace {

using emscripten::val;
using keepout::Vec3;

double number(const val& settings, const char* name) { return settings[name].as<double>(); }

std::vector<keepout::Guide> guides_of(const val& settings) {
  std::vector<keepout::Guide> guides;
  for (const std::string& text : emscripten::vecFromJSArray<std::string>(settings["guides"])) {
    guides.push_back(keepout::guide_of_text(text));
  }
  return guides;
}

/// Writes the limits that a step reports, for mesh and guides.
void show_limits(const auto& step, Cycle& cycle) noexcept {
  const std::span<const keepout::GuideState> states = step.guides;
  cycle.by_mesh = step.limits.has(keepout::Limit::mesh) ? 1.0 : 0.0;
  cycle.guides = 0.0;
  cycle.excess = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t g = 0; g < states.size(); ++g) {
    if (states[g].limits) cycle.guides += static_cast<double>(1U << g);
    cycle.excess = std::fmax(cycle.excess, states[g].excess);
  }
}

struct Tip final : Tool {
  Tip(Anatomy& of, const val& settings)
      : anatomy(of),
        spring{.stiffness = number(settings, "stiffness"),
               .largest_force = number(settings, "largestForce")},
        max_step(number(settings, "maxStep")) {
    check(spring);
    const double radius = number(settings, "toolRadius");
    bodies = {{.name = "tool", .radius = radius}};
    const auto rule = settings["rule"].as<std::string>();
    if (rule == "none") return;
    keepout::app::require_within_reach(max_step, number(settings, "radius"));
    constraint = anatomy.guard({.activation = rule,
                                .options = {.radius = number(settings, "radius"),
                                            .tool_radius = radius,
                                            .margin = number(settings, "margin"),
                                            .distances = keepout::Distances::always}});
    guides = guides_of(settings);
    constraint->set_guides(guides);
  }

  void place(std::span<const double> start) override {
    if (constraint) constraint->forget();
    move_to(Vec3(start.data()));
  }

  /// As `keepout replay --closed-loop`.
  void follow(const Vec3& hand, const Eigen::Quaterniond&) override {
    make_step({.tip = tip, .desired = keepout::app::clipped(hand - tip, max_step)}, hand);
  }

  /// As `keepout replay`.
  void step(const Vec3& from, const Vec3& desired) override {
    make_step({.tip = from, .desired = desired}, from + desired);
  }

  double clearance(std::size_t) override {
    return anatomy.clearance(tip.x(), tip.y(), tip.z()) - bodies[0].radius;
  }

  void make_step(const keepout::Motion& motion, const Vec3& hand) {
    keepout::Step step{.status = keepout::Status::free, .motion = motion.desired};
    if (constraint) step = constraint->step(motion);
    planes = step.planes;
    active = step.active;
    show_limits(step, cycle);
    cycle.distance = step.distance.value_or(std::numeric_limits<double>::quiet_NaN());
    cycle.status = static_cast<double>(step.status);
    cycle.held = static_cast<double>(active.size());
    cycle.triangles = static_cast<double>(step.triangles);
    cycle.plane_count = static_cast<double>(planes.size());
    Eigen::Map<Vec3>(cycle.motion) = step.motion;
    Eigen::Map<Vec3>(cycle.asked) = hand;
    move_to(motion.tip + step.motion);
    const Vec3 stretch = tip - hand;
    const double length = stretch.norm();
    Eigen::Map<Vec3> force(cycle.force);
    force.setZero();
    if (constraint && length > 0.0) force = stretch * (spring.spring_force(length) / length);
  }

  void move_to(const Vec3& place) {
    tip = place;
    for (double* copy : {cycle.positions, cycle.flange, cycle.cores, cycle.cores + 3}) {
      Eigen::Map<Vec3>{copy} = tip;
    }
    cycle.flange[6] = 1.0;
  }

  Anatomy& anatomy;
  // Empty: the tip follows the hand without a guard.
  std::optional<keepout::MotionConstraint> constraint;
  keepout::SpringDamper spring;
  double max_step;
  Vec3 tip = Vec3::Zero();
};

/// The largest rotation of the flange in a cycle. [rad]
constexpr double max_turn = 0.02;

/// Returns the instrument of a robot whose link 0 is at a base: a position, and rows of a rotation.
keepout::Instrument instrument_at(const val& port) {
  using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const auto robot = port["robot"].as<std::string>();
  const auto base = emscripten::convertJSArrayToNumberVector<double>(port["base"]);
  if (robot != "psm" || base.size() != 12) {
    throw keepout::Error("there is no robot '" + robot + "' in this page");
  }
  return keepout::psm({Vec3(base.data()), Eigen::Map<const Rows>(base.data() + 3)});
}

/// The least distance from the mesh of the points between two, and of `least`: where it matters to
/// a hundredth of it. A point's distance changes no faster than it moves, so parts of the way from
/// which nothing can come nearer are left out.
double distance_along(keepout::NearestTriangle& nearest, const Vec3& from, const Vec3& to,
                      double least) {
  const Vec3 middle = 0.5 * (from + to);
  const double here = nearest(middle).closest.distance;
  least = std::min(least, here);
  if (here - 0.5 * (to - from).norm() >= 0.99 * least - 0.05) return least;
  return distance_along(nearest, middle, to, distance_along(nearest, from, middle, least));
}

struct Instrument final : Tool {
  Instrument(const Anatomy& anatomy, const val& settings)
      : constraint(make_instrument_constraint(anatomy.mesh, anatomy.index,
                                              instrument_at(settings["port"]),
                                              {.options = {.margin = number(settings, "margin")}})),
        nearest(*anatomy.mesh, *anatomy.index),
        max_step(number(settings, "maxStep")) {
    const keepout::Instrument& made = constraint.instrument();
    positions = static_cast<std::size_t>(made.chain().size());
    joints = std::span(cycle.positions, positions);
    asked = 6;
    band = constraint.options().band;
    period = constraint.options().period;
    bodies.assign(made.bodies().begin(), made.bodies().end());
    guides = guides_of(settings);
    constraint.set_guides(guides);
  }

  void place(std::span<const double> start) override {
    std::copy_n(start.begin(), joints.size(), joints.begin());
    constraint.forget();
    show_bodies();
  }

  void follow(const Vec3& hand, const Eigen::Quaterniond& turn) override {
    const Eigen::AngleAxisd off(Eigen::Matrix3d(turn.normalized() * flange.rotation.transpose()));
    step(keepout::app::clipped(hand - flange.position, max_step),
         std::min(off.angle(), max_turn) * off.axis());
  }

  void step(const Vec3& linear, const Vec3& angular) noexcept override {
    const keepout::InstrumentStep step =
        constraint.step(joints, {.linear = linear, .angular = angular});
    for (std::size_t k = 0; k < joints.size(); ++k) {
      cycle.motion[k] = step.ok() ? step.increment[k] : 0.0;
      joints[k] += cycle.motion[k];
    }
    Eigen::Map<Vec3>(cycle.asked) = linear;
    Eigen::Map<Vec3>(cycle.asked + 3) = angular;
    cycle.distance = step.distance.value_or(std::numeric_limits<double>::quiet_NaN());
    cycle.status = static_cast<double>(step.status);
    cycle.held = static_cast<double>(step.rows);
    cycle.rounds = static_cast<double>(step.rounds);
    cycle.nearest = step.nearest;
    show_limits(step, cycle);
    show_bodies();
  }

  /// Accurate to a twentieth of a millimeter, or a hundredth of the distance.
  double clearance(std::size_t body) override try {
    const double* const core = cycle.cores + 6 * body;
    return distance_along(nearest, Vec3(core), Vec3(core + 3),
                          std::numeric_limits<double>::infinity()) -
           bodies[body].radius;
  } catch (const std::exception&) {
    return std::numeric_limits<double>::quiet_NaN();
  }

  /// Writes the poses of flange and bodies.
  void show_bodies() noexcept {
    keepout::ChainState state;
    constraint.instrument().chain().forward_kinematics(joints, state);
    flange = state.flange();
    Eigen::Map<Vec3>(cycle.flange) = flange.position;
    Eigen::Map<Eigen::Vector4d>(cycle.flange + 3) = Eigen::Quaterniond(flange.rotation).coeffs();
    double* core = cycle.cores;
    for (const keepout::Body& body : bodies) {
      for (const keepout::LinkPoint* point : {&body.points.front(), &body.points.back()}) {
        Eigen::Map<Vec3>{core} = state.at(point->link, point->position);
        core += 3;
      }
    }
  }

  keepout::InstrumentConstraint constraint;
  keepout::NearestTriangle nearest;
  std::span<double> joints;  // in the cycle
  double max_step;
  keepout::Pose flange;
};

}  // namespace

std::unique_ptr<Tool> make_tool(Anatomy& anatomy, const val& settings) {
  if (settings["port"].isNull()) return std::make_unique<Tip>(anatomy, settings);
  return std::make_unique<Instrument>(anatomy, settings);
}
