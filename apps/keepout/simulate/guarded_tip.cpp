// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <utility>

#include "keepout/factory/guide_text.h"
#include "shared/clip.h"
#include "shared/progress.h"
#include "simulate/guide_audit.h"
#include "simulate/tip_record.h"
#include "simulate/tool_audit.h"

namespace keepout::app {
namespace {

class GuardedTip final : public SimulatedTool {
 public:
  explicit GuardedTip(const SimulateOptions& options) : options_(options) {
    for (const std::string& text : options.guides) guides_.push_back(guide_of_text(text));
    require_within_reach(options.max_step, options.constraint.options.radius);
  }

  std::shared_ptr<const Mesh> open(const std::filesystem::path& path, const StopSignal&) override {
    const std::shared_ptr<const Mesh> mesh = load_named_mesh(path, options_.load).mesh;
    constraints_.emplace_back();
    for (const std::string& rule : options_.rules) {
      if (std::ranges::count(rules_, rule) > 0) continue;
      MotionConstraintSettings settings = options_.constraint;
      settings.activation = rule;
      settings.warn = warn_on_stderr;
      constraints_.emplace_back(make_motion_constraint(mesh, settings))->set_guides(guides_);
      rules_.push_back(rule);
    }
    audit_.emplace(mesh);
    const auto& tool = options_.constraint.tool;
    strokes_ = tip_strokes(*audit_, options_.strokes, tool ? &*tool : nullptr, guides_);
    return mesh;
  }

  std::vector<std::string> guards() const override { return rules_; }

  Stroke draw(std::uint64_t, double) override { return strokes_(); }

  StrokeStart start(const Stroke& stroke, std::size_t guard) override {
    constraint_ = constraints_[guard] ? &*constraints_[guard] : nullptr;
    tip_ = stroke.goals.front().position;
    if (options_.constraint.tool) {
      tool_path_.emplace(*audit_, *options_.constraint.tool, tip_);
    } else {
      path_.emplace(*audit_, tip_);
    }
    guide_path_.emplace(guides_, tip_);
    return {required_clearance(options_.constraint.options),
            tool_path_ ? tool_path_->clearance() : path_->clearance()};
  }

  Cycle follow(const Pose& goal) override {
    Cycle cycle;
    Vec3 motion = clipped(goal.position - tip_, options_.max_step);
    if (constraint_ != nullptr) {
      StageTimes times;
      const Step step = constraint_->step({.tip = tip_, .desired = motion}, times);
      // A motion of less than a nanometer, when more was commanded, counts as none.
      const bool is_still = step.motion.norm() < 1e-6 && motion.norm() > 1e-3;
      cycle.outcome = outcome_of(step.ok() && !is_still, step.status);
      cycle.guides_inside = guides_inside(step.guides);
      cycle.step_us = static_cast<float>(1e-3 * static_cast<double>(times.total()));
      motion = step.motion;
    }
    tip_ += motion;
    cycle.is_breach = tool_path_ ? tool_path_->follow(tip_) : path_->follow(tip_);
    cycle.is_guide_left = guide_path_->follow(tip_);
    cycle.guide_excess = guide_path_->excess();
    cycle.places.front() = tip_;
    cycle.clearances.front() = tool_path_ ? tool_path_->clearance() : path_->clearance();
    return cycle;
  }

  void keep(FollowedStroke followed) override { kept_.push_back(std::move(followed)); }

  SimulationResult result(const std::vector<RunTally>& runs) override {
    return tip_result(options_, *audit_, kept_, runs);
  }

 private:
  const SimulateOptions& options_;
  std::vector<Guide> guides_;
  std::vector<std::string> rules_{no_rule};
  std::vector<std::optional<MotionConstraint>> constraints_;  // of each rule
  std::optional<Audit> audit_;
  std::function<Stroke()> strokes_;
  std::vector<FollowedStroke> kept_;
  MotionConstraint* constraint_ = nullptr;  // null: no guard
  Vec3 tip_ = Vec3::Zero();
  std::optional<PathAudit> path_;       // for a ball
  std::optional<ToolAudit> tool_path_;  // for a convex tool
  std::optional<GuideAudit> guide_path_;
};

}  // namespace

std::unique_ptr<SimulatedTool> make_guarded_tip(const SimulateOptions& options) {
  return std::make_unique<GuardedTip>(options);
}

}  // namespace keepout::app
