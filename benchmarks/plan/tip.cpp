// SPDX-License-Identifier: BSD-3-Clause
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "keepout/activation/certified.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/index/query.h"
#include "keepout/ompl/planning.h"
#include "keepout/ompl/straight_way.h"
#include "plan/planning.h"

namespace keepout::app {
namespace {

namespace base = ompl::base;

/// Tips are not classified: a certified motion never changes the side, whatever the winding, so a
/// tree that starts within the mesh stays within it.
constexpr Inside sides = Inside::taken_as_is;

/// The validity checker that a user of OMPL would write: no triangle is within the clearance, by
/// the fastest index here. It does not classify positions, which would only cost time: a tree
/// starts on the right side. For one thread.
class ClearPlaces final : public base::StateValidityChecker {
 public:
  ClearPlaces(const base::SpaceInformationPtr& space, const Scene& scene, double clearance)
      : StateValidityChecker(space),
        scene_(&scene),
        clearance_(clearance),
        candidates_(scene.mesh()->triangle_count()),
        hits_(scene.mesh()->triangle_count()) {}

  bool isValid(const base::State* state) const override {
    if (!si_->satisfiesBounds(state)) return false;
    const double* const tip = state->as<base::RealVectorStateSpace::StateType>()->values;
    const Ball ball{{tip[0], tip[1], tip[2]}, clearance_};
    candidates_.clear();
    scene_->index().collect(ball, candidates_);
    if (candidates_.view().empty()) return true;
    hits_.clear();
    refine(*scene_->mesh(), ball, candidates_.view(), hits_);
    return hits_.view().empty();
  }

 private:
  const Scene* scene_;
  double clearance_;
  mutable TriangleBuffer candidates_;
  mutable HitBuffer hits_;
};

class TipPlanning final : public Planning {
 public:
  TipPlanning(const PlanOptions& options, TipScene where)
      : options_(&options), where_(std::move(where)) {}

  const Scene& scene() const override { return where_.scene; }
  bool is_within() const override { return where_.is_within; }

  std::vector<PlanningProblem> draw(const StopSignal& stop) override {
    return draw_problems(where_, options_->clearance(), options_->problems, options_->seed, stop);
  }

  void open(const PlanningProblem&) override {
    if (steering_) return;
    steering_ = std::make_shared<GuardPool>([this] {
      return make_motion_constraint(scene().mesh(), scene().shared_index(),
                                    {.options = {.radius = options_->radius,
                                                 .tool_radius = options_->tool_radius,
                                                 .margin = options_->margin},
                                     .inside = sides});
    });
    // As above, but with a solver that does not search for other motions.
    validating_ = std::make_shared<GuardPool>([this] {
      return MotionConstraint(scene().mesh(), scene().shared_index(),
                              std::make_unique<CertifiedRule>(), std::make_unique<StraightOnly>(),
                              {.radius = options_->radius, .margin = options_->clearance()}, {},
                              sides);
    });
  }

  base::StateSpacePtr space() const override {
    auto space = std::make_shared<base::RealVectorStateSpace>(3);
    base::RealVectorBounds limits(3);
    std::ranges::copy(where_.bounds.low, limits.low.begin());
    std::ranges::copy(where_.bounds.high, limits.high.begin());
    space->setBounds(limits);
    return space;
  }

  Checks checks(const base::SpaceInformationPtr& space, const Checker& checker) override {
    if (checker.is_keepouts()) {
      const std::shared_ptr<GuardPool>& guards = checker.slides() ? steering_ : validating_;
      return {make_state_validity_checker(space, guards), make_motion_validator(space, guards)};
    }
    // Between two places at this spacing, a distance falls by at most half the spacing.
    const double apart = checker.resolution * space->getStateSpace()->getMaximumExtent();
    const bool is_widened = checker.kind == Checker::Kind::widened;
    const double clearance = options_->clearance() + (is_widened ? 0.5 * apart : 0.0);
    return {std::make_shared<ClearPlaces>(space, scene(), clearance)};
  }

  base::PlannerPtr sliding(const base::SpaceInformationPtr& space) override {
    return make_sliding_connect(space, steering_);
  }

  /// Judges the whole of each straight piece.
  Json judge(const Path& path) override {
    std::vector<Vec3> points;
    for (const std::vector<double>& tip : path) points.emplace_back(tip.data());
    oracle::SafetyOracle oracle = scene().oracle();
    // A piece is no farther from the mesh than its ends, which bounds the search.
    double clearance = std::numeric_limits<double>::infinity();
    for (const Vec3& point : points) clearance = std::min(clearance, oracle.distance(point));
    bool enters = false;
    std::size_t bad_pieces = 0;  // pieces that touch the mesh or come too close
    double length = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const oracle::Finding finding =
          oracle.check(points[i - 1], points[i], least_distance(), clearance);
      clearance = std::min(clearance, finding.distance);
      enters |= finding.crosses;
      bad_pieces += finding.crosses || finding.below;
      length += (points[i] - points[i - 1]).norm();
    }
    return {{"valid", bad_pieces == 0},
            {"enters", enters},
            {"bad_pieces", bad_pieces},
            {"pieces", points.size() - 1},
            {"clearance_mm", clearance},
            {"length_mm", length},
            {"path", path},
            {"too_near", bad_pieces == 0 ? Json::array() : lengths_too_near(points)}};
  }

 private:
  /// Returns the least distance that docs/certified-step.md promises: m - 3 tau. [mm]
  double least_distance() const {
    // The tip may be 10 mm beyond the mesh along each axis.
    const Vec3 farthest(scene().farthest() + 30.0, 0.0, 0.0);
    const double margin = options_->clearance();
    return margin - 3.0 * scene().judged().tolerance({.radius = options_->radius, .margin = margin},
                                                     farthest);
  }

  /// Returns the parts of an invalid path that come too close, to half a millimeter.
  Json lengths_too_near(const std::vector<Vec3>& points) const {
    constexpr double longest = 0.5;  // of a judged piece [mm]
    oracle::SafetyOracle oracle = scene().oracle();
    Json lengths = Json::array();
    bool was_bad = false;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Vec3 along = points[i] - points[i - 1];
      const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm() / longest)));
      for (int k = 0; k < pieces; ++k) {
        const Vec3 from = points[i - 1] + along * (static_cast<double>(k) / pieces);
        const Vec3 to = points[i - 1] + along * (static_cast<double>(k + 1) / pieces);
        const bool is_bad = oracle.check(from, to, least_distance()).below;
        if (is_bad && !was_bad) lengths.push_back(Json::array({json_of(from)}));
        if (is_bad) lengths.back().push_back(json_of(to));
        was_bad = is_bad;
      }
    }
    return lengths;
  }

  const PlanOptions* options_;
  TipScene where_;
  std::shared_ptr<GuardPool> steering_, validating_;
};

}  // namespace

std::unique_ptr<Planning> planning_of_a_tip(const PlanOptions& options, Scene scene) {
  // The airway: from the throat up into nose and sinuses, unless the user names a mesh.
  const bool is_airway = options.meshes.empty() && scene.name() == "airway";
  TipScene where{.scene = std::move(scene),
                 .is_within = is_airway || options.inside,
                 .starts_below = is_airway};
  constexpr double room_around = 10.0;  // [mm]
  const Vec3 room = Vec3::Constant(where.is_within ? 0.0 : room_around);
  const Box& bounds = where.scene.mesh()->bounds();
  where.bounds = {bounds.low - room, bounds.high + room};
  return std::make_unique<TipPlanning>(options, std::move(where));
}

}  // namespace keepout::app
