// SPDX-License-Identifier: BSD-3-Clause
//
// What the page with a whole instrument calls beside exports.cpp: instruments are made on anatomy,
// and follow a hand, cycle by cycle. Lengths in mm, in the frame of the mesh.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy.h"
#include "json_text.h"
#include "keepout/error.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/fixtures/robots.h"
#include "keepout/index/query.h"
#include "keepout/robot/instrument_constraint.h"
#include "shared/clip.h"

namespace {

using keepout::Vec3;

/// How far a hand may turn the flange in a cycle. [rad]
constexpr double max_turn = 0.02;

/// A robot that a page may name.
keepout::Instrument robot_named(std::string_view name, const keepout::Pose& base) {
  if (name == "psm") return keepout::psm(base);
  throw keepout::Error("there is no robot '" + std::string(name) + "' in this page");
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

}  // namespace

/// What a control cycle of an instrument came to, as it lies in memory. Valid until the next call.
struct InstrumentCycle {
  double positions[8];  // of the joints, after the cycle [rad or mm]
  double increment[8];  // that led there
  double twist[6];      // that was asked of the flange: how it shall move [mm] and turn [rad]
  double flange[7];     // where it is after the cycle, and how it is turned: a quaternion, x y z w
  double distance;      // of the body nearest to the surface, before it; NaN: farther off [mm]
  double cores[6 * keepout::Instrument::most_bodies];  // both ends of each body, after it
  std::uint32_t status;                                // keepout_status_name has its name
  std::uint32_t rows;                                  // that hold the motion back
  std::uint32_t rounds;                                // trial motions that were judged
  std::int32_t nearest;                                // number of that body; -1: none is near
};
static_assert(offsetof(InstrumentCycle, increment) == 64 &&
              offsetof(InstrumentCycle, twist) == 128);
static_assert(offsetof(InstrumentCycle, flange) == 176);
static_assert(offsetof(InstrumentCycle, distance) == 232);
static_assert(offsetof(InstrumentCycle, cores) == 240 && offsetof(InstrumentCycle, status) == 1008);

/// An instrument that keeps off an anatomy, and where its joints are.
struct Manipulator {
  Manipulator(const Anatomy& anatomy, const keepout::Instrument& made,
              const keepout::InstrumentOptions& options)
      : constraint(
            make_instrument_constraint(anatomy.mesh, anatomy.index, made, {.options = options})),
        nearest(*anatomy.mesh, *anatomy.index),
        positions(static_cast<std::size_t>(made.chain().size())) {}

  const keepout::Instrument& instrument() const noexcept { return constraint.instrument(); }

  /// The joints are where they are said to be: so are the bodies.
  void place() noexcept {
    keepout::ChainState state;
    instrument().chain().forward_kinematics(positions, state);
    std::copy(positions.begin(), positions.end(), cycle.positions);
    flange = state.flange();
    Eigen::Map<Vec3>(cycle.flange) = flange.position;
    const Eigen::Quaterniond turn(flange.rotation);
    Eigen::Map<Eigen::Vector4d>(cycle.flange + 3) = turn.coeffs();
    double* core = cycle.cores;
    for (const keepout::Body& body : instrument().bodies()) {
      for (const keepout::LinkPoint* point : {&body.points.front(), &body.points.back()}) {
        Eigen::Map<Vec3> end(core);
        end = state.at(point->link, point->position);
        core += 3;
      }
    }
  }

  const InstrumentCycle* move(const keepout::Twist& twist) noexcept {
    const keepout::InstrumentStep step = constraint.step(positions, twist);
    for (std::size_t k = 0; k < positions.size(); ++k) {
      cycle.increment[k] = step.ok() ? step.increment[k] : 0.0;
      positions[k] += cycle.increment[k];
    }
    Eigen::Map<Vec3>(cycle.twist) = twist.linear;
    Eigen::Map<Vec3>(cycle.twist + 3) = twist.angular;
    cycle.distance = step.distance.value_or(std::numeric_limits<double>::quiet_NaN());
    cycle.status = static_cast<std::uint32_t>(step.status);
    cycle.rows = static_cast<std::uint32_t>(step.rows);
    cycle.rounds = static_cast<std::uint32_t>(step.rounds);
    cycle.nearest = step.nearest;
    place();
    return &cycle;
  }

  keepout::InstrumentConstraint constraint;
  keepout::NearestTriangle nearest;
  std::vector<double> positions;
  keepout::Pose flange;
  InstrumentCycle cycle = {};
};

extern "C" {

/// An instrument by the name of its robot, whose link 0 is at `base`: where, and the rows of its
/// rotation (12). Null on failure.
Manipulator* keepout_make_instrument(const Anatomy* anatomy, const char* robot, const double* base,
                                     double margin) {
  return keepout::web::made([&] {
    using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const keepout::Pose pose{Vec3(base), Eigen::Map<const Rows>(base + 3)};
    return std::make_unique<Manipulator>(*anatomy, robot_named(robot, pose),
                                         keepout::InstrumentOptions{.margin = margin});
  });
}

/// Frees an instrument.
void keepout_discard_instrument(Manipulator* manipulator) { delete manipulator; }

/// Name and radius of each body, as a JSON list; and the band, period and joints that it has.
const char* keepout_instrument_facts(const Manipulator* manipulator) {
  static std::string text;
  const keepout::InstrumentOptions& options = manipulator->constraint.options();
  const auto body = [](const keepout::Body& one) {
    return R"({"name":)" + keepout::web::json(std::string_view(one.name)) + R"(,"radius":)" +
           keepout::web::json(one.radius) + '}';
  };
  text = R"({"joints":)" + keepout::web::json(manipulator->positions.size()) + R"(,"band":)" +
         keepout::web::json(options.band) + R"(,"period":)" + keepout::web::json(options.period) +
         R"(,"bodies":)" + keepout::web::json_list(manipulator->instrument().bodies(), body) + '}';
  return text.c_str();
}

/// Puts the joints there, and forgets the past.
const InstrumentCycle* keepout_place_instrument(Manipulator* manipulator, const double* positions) {
  std::copy_n(positions, manipulator->positions.size(), manipulator->positions.begin());
  manipulator->constraint.forget();
  manipulator->cycle = {};
  manipulator->cycle.distance = std::numeric_limits<double>::quiet_NaN();
  manipulator->cycle.nearest = -1;
  manipulator->place();
  return &manipulator->cycle;
}

/// One control cycle towards where a hand wants the flange: a place and a quaternion, x y z w (7).
/// It is led `max_step` and 0.02 rad at most.
const InstrumentCycle* keepout_lead_instrument(Manipulator* manipulator, const double* hand,
                                               double max_step) {
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(hand[6], hand[3], hand[4], hand[5]).normalized();
  const Eigen::AngleAxisd off(Eigen::Matrix3d(turn * manipulator->flange.rotation.transpose()));
  return manipulator->move(
      {.linear = keepout::app::clipped(Vec3(hand) - manipulator->flange.position, max_step),
       .angular = std::min(off.angle(), max_turn) * off.axis()});
}

/// One control cycle in which just this is asked of the flange (6).
const InstrumentCycle* keepout_move_instrument(Manipulator* manipulator, const double* twist) {
  return manipulator->move({.linear = Vec3(twist), .angular = Vec3(twist + 3)});
}

/// From the surface of a body to the mesh, for people: to a twentieth of a millimetre, or a
/// hundredth of what it is. [mm]
double keepout_body_clearance(Manipulator* manipulator, std::uint32_t body) {
  const Eigen::Map<const Vec3> from(manipulator->cycle.cores + 6 * body);
  const Eigen::Map<const Vec3> to(manipulator->cycle.cores + 6 * body + 3);
  return distance_along(manipulator->nearest, from, to, std::numeric_limits<double>::infinity()) -
         manipulator->instrument().bodies()[body].radius;
}

}  // extern "C"
