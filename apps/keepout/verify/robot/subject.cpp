// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/subject.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "keepout/activation/certified.h"
#include "keepout/activation/convex_tool_rule.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"

namespace keepout::app {
namespace {

using oracle::JudgedGuide;

Region region_of(const JudgedGuide& guide) {
  switch (guide.region) {
    case JudgedGuide::Region::half_space:
      return Region::half_space(guide.origin, guide.direction);
    case JudgedGuide::Region::slab:
      return Region::slab(guide.origin, guide.direction, guide.radius);
    case JudgedGuide::Region::tube:
      return Region::tube(guide.origin, guide.direction, guide.radius);
    case JudgedGuide::Region::ball:
      break;
  }
  return Region::ball(guide.origin, guide.radius);
}

Guide guide_of(const JudgedGuide& guide) {
  const LinkPoint first{guide.first.link, guide.first.position};
  const LinkPoint second{guide.second.link, guide.second.position};
  const auto of_kind = [&] {
    if (guide.kind == JudgedGuide::Kind::point)
      return Guide::point("point", first, region_of(guide));
    if (guide.kind == JudgedGuide::Kind::axis) {
      const double angle = 2.0 * std::asin(0.5 * guide.radius);
      return Guide::axis("axis", first.link, first.position, guide.origin, angle);
    }
    return Guide::remote_center("shaft", first, second, guide.origin, guide.radius);
  };
  return of_kind().with_band(guide.band);
}

class InstrumentSubject final : public RobotSubject {
 public:
  explicit InstrumentSubject(const RobotSetup& setup)
      : constraint_(setup.meshes[0].scene->mesh(), setup.meshes[0].scene->shared_index(),
                    setup.robot.make(setup.start.base), make_solver("active_set"), setup.options) {
    for (std::size_t m = 1; m < setup.meshes.size(); ++m) {
      const SetupMesh& mesh = setup.meshes[m];
      constraint_.add_mesh(mesh.scene->mesh(), mesh.scene->shared_index(), mesh.margin);
    }
    std::vector<Guide> guides;
    for (const JudgedGuide& guide : setup.guides) guides.push_back(guide_of(guide));
    constraint_.set_guides(std::move(guides));
  }

  void set_options(const InstrumentOptions& options) override { constraint_.set_options(options); }
  void place(std::size_t mesh, const Pose& pose, const Twist& velocity) override {
    constraint_.place(mesh, pose, velocity);
  }
  InstrumentStep step(std::span<const double> positions, const Twist& desired) override {
    return constraint_.step(positions, desired);
  }
  std::size_t work_units() const override { return constraint_.work_units(); }
  double tolerance() const override { return constraint_.tolerance(); }

 private:
  InstrumentConstraint constraint_;
};

/// A tip on joints that slide along orthogonal axes: converts the step of the tip into a motion of
/// the joints.
class TipSubject final : public RobotSubject {
 public:
  explicit TipSubject(const RobotSetup& setup)
      : chain_(setup.robot.make(setup.start.base).chain()),
        bodies_(setup.robot.judged().bodies),
        is_hull_(setup.scenario->attacked == Attacked::convex_tool),
        longest_edge_(setup.meshes[0].scene->judged().longest_edge()),
        increment_(static_cast<std::size_t>(chain_.size())) {
    chain_.forward_kinematics(setup.start.positions, state_);
    options_ = {.radius = 2.0 * setup.speed,
                .tool_radius = is_hull_ ? 0.0 : bodies_.back().radius,
                .margin = setup.options.margin};
    constraint_.emplace(setup.meshes[0].scene->mesh(), setup.meshes[0].scene->shared_index(),
                        rule(), make_solver("active_set"), options_);
    std::vector<Guide> guides;
    for (const JudgedGuide& guide : setup.guides) {
      guides.push_back(Guide::point("guide", region_of(guide)).with_band(guide.band));
    }
    constraint_->set_guides(std::move(guides));
  }

  void set_options(const InstrumentOptions& options) override {
    options_.margin = options.margin;
    constraint_->set_options(options_);
  }
  void place(std::size_t, const Pose&, const Twist&) override {}
  InstrumentStep step(std::span<const double> positions, const Twist& desired) override {
    chain_.forward_kinematics(positions, state_);
    const Motion motion{.tip = state_.flange().position, .desired = desired.linear};
    const Step made = constraint_->step(motion);
    InstrumentStep step{.status = made.status};
    if (!made.ok()) return step;
    for (int k = 1; k <= chain_.size(); ++k) {
      increment_[static_cast<std::size_t>(k - 1)] = state_.axis(k).dot(made.motion);
    }
    step.increment = increment_;
    return step;
  }
  double tolerance() const override {
    const double lengths = longest_edge_ + options_.radius + required_clearance(options_);
    const Vec3 tip = state_.flange().position;
    if (!is_hull_) return 2e-10 * lengths + 4e-16 * tip.lpNorm<1>();
    double size = 0.0;
    for (const monitor::JudgedPoint& point : bodies_.back().points) {
      size = std::max(size, point.position.norm());
    }
    return 1e-12 * (longest_edge_ + 2.0 * size + 2.0 * options_.margin + tip.lpNorm<1>()) +
           1e-10 * options_.radius;
  }

 private:
  std::unique_ptr<ActivationRule> rule() const {
    if (!is_hull_) return std::make_unique<CertifiedRule>();
    std::vector<Vec3> points;
    for (const monitor::JudgedPoint& point : bodies_.back().points) {
      points.push_back(state_.at(point.link, point.position) - state_.flange().position);
    }
    return std::make_unique<ConvexToolRule>(ConvexTool::hull(points, bodies_.back().radius));
  }

  Chain chain_;
  ChainState state_;
  std::vector<monitor::JudgedBody> bodies_;
  bool is_hull_;
  double longest_edge_;  // of the mesh [length]
  StepOptions options_;
  std::optional<MotionConstraint> constraint_;
  std::vector<double> increment_;
};

}  // namespace

std::unique_ptr<RobotSubject> make_subject(const RobotSetup& setup) {
  if (setup.scenario->attacked == Attacked::instrument) {
    return std::make_unique<InstrumentSubject>(setup);
  }
  return std::make_unique<TipSubject>(setup);
}

}  // namespace keepout::app
