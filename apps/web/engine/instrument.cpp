// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <span>

#include "json_text.h"
#include "keepout/error.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/fixtures/robots.h"
#include "keepout/index/query.h"
#include "keepout/robot/instrument_constraint.h"
#include "shared/clip.h"
#include "tool.h"

namespace {

using keepout::Vec3;

/// The largest rotation of the flange in a cycle. [rad]
constexpr double max_turn = 0.02;

keepout::Instrument robot_named(std::string_view name, const double* base) {
  using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  if (name == "psm") return keepout::psm({Vec3(base), Eigen::Map<const Rows>(base + 3)});
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

std::string json_of(const keepout::Body& body) {
  return R"({"name":)" + keepout::web::json(std::string_view(body.name)) + R"(,"radius":)" +
         keepout::web::json(body.radius) + '}';
}

struct Instrument final : Tool {
  Instrument(const Anatomy& anatomy, const keepout::Instrument& made,
             const InstrumentSettings& settings)
      : constraint(make_instrument_constraint(anatomy.mesh, anatomy.index, made,
                                              {.options = {.margin = settings.margin}})),
        nearest(*anatomy.mesh, *anatomy.index),
        positions(cycle.positions, static_cast<std::size_t>(made.chain().size())),
        max_step(settings.max_step) {
    const keepout::InstrumentOptions& options = constraint.options();
    facts = R"({"positions":)" + keepout::web::json(positions.size()) + R"(,"band":)" +
            keepout::web::json(options.band) + R"(,"period":)" +
            keepout::web::json(options.period) + R"(,"bodies":)" +
            keepout::web::json_list(instrument().bodies(), json_of) + '}';
  }

  const keepout::Instrument& instrument() const noexcept { return constraint.instrument(); }

  void place(const double* start) override {
    std::copy_n(start, positions.size(), positions.begin());
    constraint.forget();
    show_bodies();
  }

  void follow(const double* hand) override {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(hand[6], hand[3], hand[4], hand[5]).normalized();
    const Eigen::AngleAxisd off(Eigen::Matrix3d(turn * flange.rotation.transpose()));
    step({.linear = keepout::app::clipped(Vec3(hand) - flange.position, max_step),
          .angular = std::min(off.angle(), max_turn) * off.axis()});
  }

  void step(const double* asked) override {
    step({.linear = Vec3(asked), .angular = Vec3(asked + 3)});
  }

  /// To a twentieth of a millimeter, or a hundredth of the distance.
  double clearance(std::size_t body) override {
    const double* const core = cycle.cores + 6 * body;
    return distance_along(nearest, Vec3(core), Vec3(core + 3),
                          std::numeric_limits<double>::infinity()) -
           instrument().bodies()[body].radius;
  }

  void step(const keepout::Twist& twist) noexcept {
    const keepout::InstrumentStep step = constraint.step(positions, twist);
    for (std::size_t k = 0; k < positions.size(); ++k) {
      cycle.motion[k] = step.ok() ? step.increment[k] : 0.0;
      positions[k] += cycle.motion[k];
    }
    Eigen::Map<Vec3>(cycle.asked) = twist.linear;
    Eigen::Map<Vec3>(cycle.asked + 3) = twist.angular;
    cycle.distance = step.distance.value_or(std::numeric_limits<double>::quiet_NaN());
    cycle.status = static_cast<std::uint32_t>(step.status);
    cycle.held = static_cast<std::uint32_t>(step.rows);
    cycle.rounds = static_cast<std::uint32_t>(step.rounds);
    cycle.nearest = step.nearest;
    show_bodies();
  }

  /// Writes where flange and bodies are.
  void show_bodies() noexcept {
    keepout::ChainState state;
    instrument().chain().forward_kinematics(positions, state);
    flange = state.flange();
    Eigen::Map<Vec3>(cycle.flange) = flange.position;
    Eigen::Map<Eigen::Vector4d>(cycle.flange + 3) = Eigen::Quaterniond(flange.rotation).coeffs();
    double* core = cycle.cores;
    for (const keepout::Body& body : instrument().bodies()) {
      for (const keepout::LinkPoint* point : {&body.points.front(), &body.points.back()}) {
        Eigen::Map<Vec3>{core} = state.at(point->link, point->position);
        core += 3;
      }
    }
  }

  keepout::InstrumentConstraint constraint;
  keepout::NearestTriangle nearest;
  std::span<double> positions;
  double max_step;
  keepout::Pose flange;
};

}  // namespace

std::unique_ptr<Tool> make_instrument(const Anatomy& anatomy, std::string_view robot,
                                      const InstrumentSettings& settings) {
  return std::make_unique<Instrument>(anatomy, robot_named(robot, settings.base), settings);
}
