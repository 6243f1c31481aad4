// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "keepout/error.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/fixtures/robots.h"
#include "keepout/index/query.h"
#include "keepout/robot/instrument_constraint.h"
#include "keepout/solvers/active_set.h"
#include "shared/clip.h"
#include "tool_parts.h"

namespace {

using emscripten::val;
using keepout::Vec3;

/// The largest rotation of the flange in a cycle. [rad]
constexpr double max_turn = 0.02;
/// A core that is nearer to the surface may pass through it. [mm]
constexpr double at_surface = 0.05;

/// Returns an instrument whose last body, the jaw, is open: two jaws, which turn about the last
/// joint to both sides by half of `opening`. [rad]
keepout::Instrument opened(const keepout::Instrument& closed, double opening) {
  if (!(opening > 0.0)) return closed;
  std::vector<keepout::Body> bodies(closed.bodies().begin(), closed.bodies().end());
  const keepout::Body jaw = bodies.back();
  bodies.pop_back();
  for (const double side : {-0.5, 0.5}) {
    Vec3& end = bodies.emplace_back(jaw).points.back().position;
    end = Eigen::AngleAxisd(side * opening, Vec3::UnitZ()) * end;
  }
  return {closed.chain(), std::move(bodies)};
}

/// Returns the instrument of a robot whose link 0 is at a base: a position, and rows of a rotation.
keepout::Instrument instrument_at(const val& settings) {
  using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const val port = settings["port"];
  const auto robot = port["robot"].as<std::string>();
  const auto base = emscripten::convertJSArrayToNumberVector<double>(port["base"]);
  if (robot != "psm" || base.size() != 12) {
    throw keepout::Error("there is no robot '" + robot + "' in this page");
  }
  return opened(keepout::psm({Vec3(base.data()), Eigen::Map<const Rows>(base.data() + 3)}),
                number(settings, "opening") * std::numbers::pi / 180.0);
}

/// A point of a core, and its distance from the mesh. [mm]
struct NearPoint {
  double distance = std::numeric_limits<double>::infinity();
  Vec3 place = Vec3::Zero();
};

/// Finds the least distance of the points between two, if it is less than that of `least`: accurate
/// to `accuracy` and to a hundredth of the distance. A point's distance changes no faster than it
/// moves, so parts of the segment from which nothing can come nearer are left out.
NearPoint least_along(const auto& distance, const Vec3& from, const Vec3& to, double accuracy,
                      NearPoint least = {}) {
  const Vec3 middle = 0.5 * (from + to);
  const double here = distance(middle);
  if (here < least.distance) least = {here, middle};
  const double slack = accuracy + 0.01 * std::abs(least.distance);
  if (here - 0.5 * (to - from).norm() >= least.distance - slack) return least;
  return least_along(distance, middle, to, accuracy,
                     least_along(distance, from, middle, accuracy, least));
}

struct Instrument final : Tool {
  /// The rule "certified" guards all bodies, "tip_only" a ball at the end of the jaw, and "none"
  /// nothing. Without a mesh, the step is damped least squares within the joint limits.
  Instrument(Anatomy& of, const val& settings)
      : anatomy(of),
        constraint(instrument_at(settings), std::make_unique<keepout::ActiveSet>(),
                   {.margin = number(settings, "margin")}),
        nearest(*of.mesh, *of.index),
        max_step(number(settings, "maxStep")) {
    const keepout::Instrument& made = constraint.instrument();
    positions = static_cast<std::size_t>(made.chain().size());
    joints = std::span(cycle.positions, positions);
    asked = 6;
    band = constraint.options().band;
    period = constraint.options().period;
    bodies.assign(made.bodies().begin(), made.bodies().end());
    end = {static_cast<int>(positions), made.chain().flange().position};
    const auto rule = settings["rule"].as<std::string>();
    if (rule == "certified") {
      constraint = make_instrument_constraint(of.mesh, of.index, instrument_at(settings),
                                              {.options = {.margin = number(settings, "margin")}});
    } else if (rule == "tip_only") {
      keepout::app::require_within_reach(max_step, number(settings, "radius"));
      tip = of.guard({.options = {.radius = number(settings, "radius"),
                                  .tool_radius = bodies.back().radius,
                                  .margin = number(settings, "margin")}});
    } else if (rule != "none") {
      throw keepout::Error("an instrument has no rule '" + rule + "'");
    }
    guides = guides_of(settings);
    constraint.set_guides(guides);
  }

  void place(std::span<const double> start) override {
    std::copy_n(start.begin(), joints.size(), joints.begin());
    constraint.forget();
    if (tip) tip->forget();
    show_bodies();
  }

  void follow(const Vec3& hand, const Eigen::Quaterniond& turn) override {
    const Eigen::AngleAxisd off(Eigen::Matrix3d(turn.normalized() * flange.rotation.transpose()));
    step(keepout::app::clipped(hand - flange.position, max_step),
         std::min(off.angle(), max_turn) * off.axis());
  }

  void step(const Vec3& linear, const Vec3& angular) noexcept override {
    Vec3 allowed = linear;
    keepout::Step guarded;
    if (tip) {
      guarded = tip->step({.tip = flange.position, .desired = linear});
      allowed = guarded.motion;
    }
    const keepout::InstrumentStep step =
        constraint.step(joints, {.linear = allowed, .angular = angular});
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
    // Both steps number their statuses alike.
    if (tip && guarded.status != keepout::Status::free) {
      if (step.ok()) cycle.status = static_cast<double>(guarded.status);
      cycle.held += static_cast<double>(guarded.active.size());
      if (guarded.limits.has(keepout::Limit::mesh)) cycle.by_mesh = 1.0;
    }
    show_bodies();
  }

  double clearance(std::size_t body) override try {
    return deepest(body, at_surface).distance - bodies[body].radius;
  } catch (const std::exception&) {
    return std::numeric_limits<double>::quiet_NaN();
  }

  std::optional<Contact> contact(std::size_t body) override try {
    const NearPoint point = deepest(body, 0.1 * at_surface);
    const keepout::Hit hit = nearest(point.place);
    return Contact{.core = point.place, .surface = point.place + hit.closest.offset};
  } catch (const std::exception&) {
    return std::nullopt;
  }

  /// Returns the point of a body's core with the least distance from the mesh; below 0 inside a
  /// watertight mesh.
  NearPoint deepest(std::size_t body, double accuracy) {
    const double* const core = cycle.cores + 6 * body;
    const auto least = [&](const auto& distance) {
      return least_along(distance, Vec3(core), Vec3(core + 3), accuracy);
    };
    const NearPoint unsigned_least =
        least([&](const Vec3& at) { return nearest(at).closest.distance; });
    const auto signed_distance = [&](const Vec3& at) {
      const double distance = anatomy.clearance(at.x(), at.y(), at.z());
      return std::isnan(distance) ? nearest(at).closest.distance : distance;
    };
    if (unsigned_least.distance > at_surface && signed_distance(unsigned_least.place) > 0.0) {
      return unsigned_least;
    }
    return least(signed_distance);
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

  Anatomy& anatomy;
  keepout::InstrumentConstraint constraint;
  std::optional<keepout::MotionConstraint> tip;  // guards the end of the jaw alone
  keepout::NearestTriangle nearest;
  std::span<double> joints;  // in the cycle
  double max_step;
  keepout::Pose flange;
};

}  // namespace

std::unique_ptr<Tool> make_instrument(Anatomy& anatomy, const val& settings) {
  return std::make_unique<Instrument>(anatomy, settings);
}
