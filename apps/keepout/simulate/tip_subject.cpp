// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>

#include "keepout/activation/registry.h"
#include "shared/clip.h"
#include "shared/progress.h"
#include "simulate/tip_record.h"

namespace keepout::app {
namespace {

Json settings_of(const SimulateOptions& options) {
  const StepOptions& step = options.constraint.options;
  return {{"mesh", options.meshes.front().string()},
          {"index", options.constraint.index},
          {"solver", options.constraint.solver},
          {"motion sphere radius", keepout::text_of(step.radius) + " mm"},
          {"tool radius", keepout::text_of(step.tool_radius) + " mm"},
          {"margin", keepout::text_of(step.margin) + " mm"},
          {"refinements", std::to_string(step.refinements)},
          {"branches", std::to_string(step.nodes)},
          {"longest step asked for", keepout::text_of(options.max_step) + " mm"},
          {"seed", std::to_string(options.strokes.seed)},
          {"strokes", std::to_string(options.strokes.count)},
          {"cycles per stroke", std::to_string(options.strokes.cycles)}};
}

class TipSubject final : public Subject {
 public:
  explicit TipSubject(const SimulateOptions& options) : options_(options) {
    const StepOptions& step = options.constraint.options;
    require_within_reach(options.max_step, step.radius);
    simulation_.margin = step.tool_radius + step.margin;
    simulation_.command = options.command;
    simulation_.settings = settings_of(options);
  }

  std::shared_ptr<const Mesh> open(const std::filesystem::path& mesh) override {
    const LoadedMesh loaded = load_named_mesh(mesh, options_.load);
    add_rule(no_rule, "the tool goes where the hand goes");
    constraints_.emplace_back();
    for (const std::string& rule : options_.rules) {
      if (std::ranges::count(simulation_.rules, rule) > 0) continue;
      MotionConstraintSettings settings = options_.constraint;
      settings.activation = rule;
      settings.warn = warn_on_stderr;
      constraints_.emplace_back(make_motion_constraint(loaded.mesh, settings));
      add_rule(rule, activation_rules().named(rule).description);
    }
    simulation_.mesh_name = mesh.stem().string();
    simulation_.mesh = loaded.mesh.get();
    audit_.emplace(loaded.mesh);
    simulation_.surface = audit_->surface();
    strokes_.emplace(*audit_, options_.strokes);
    return loaded.mesh;
  }

  const std::vector<std::string>& guards() const override { return simulation_.rules; }

  Stroke draw(std::uint64_t, double) override { return strokes_->next(); }

  double start(const Stroke& stroke, std::size_t guard) override {
    constraint_ = constraints_[guard] ? &*constraints_[guard] : nullptr;
    tip_ = stroke.goals.front().position;
    path_.emplace(*audit_, tip_);
    return simulation_.margin;
  }

  Cycle follow(const Pose& goal) override {
    Cycle cycle;
    Vec3 motion = clipped(goal.position - tip_, options_.max_step);
    if (constraint_ != nullptr) {
      StageTimes times;
      const Step step = constraint_->step({.tip = tip_, .desired = motion}, times);
      // Less than a nanometer when more was commanded is standing still.
      const bool is_still = step.motion.norm() < 1e-6 && motion.norm() > 1e-3;
      cycle.outcome = !step.ok() || is_still        ? Outcome::stopped
                      : step.status != Status::free ? Outcome::limited
                                                    : Outcome::moved_freely;
      cycle.step_us = static_cast<float>(1e-3 * static_cast<double>(times.total()));
      motion = step.motion;
    }
    tip_ += motion;
    cycle.is_crossing = path_->follow(tip_);
    cycle.places.front() = tip_;
    cycle.clearances.front() = path_->clearance();
    return cycle;
  }

  void keep(FollowedStroke followed) override {
    simulation_.strokes.push_back(std::move(followed));
  }

  SimulationResult result(const std::vector<RunTally>&, const std::vector<RunTally>& totals) override {
    return {.record = record_of(simulation_, totals), .columns = tip_columns(simulation_.surface)};
  }

 private:
  void add_rule(std::string_view rule, std::string_view description) {
    simulation_.rules.emplace_back(rule);
    simulation_.descriptions.emplace_back(description);
  }

  const SimulateOptions& options_;
  TipSimulation simulation_;
  std::vector<std::optional<MotionConstraint>> constraints_;  // of each rule
  std::optional<Audit> audit_;
  std::optional<TipStrokes> strokes_;
  std::optional<PathAudit> path_;
  MotionConstraint* constraint_ = nullptr;  // null: none
  Vec3 tip_ = Vec3::Zero();
};

}  // namespace

std::unique_ptr<Subject> make_tip_subject(const SimulateOptions& options) {
  return std::make_unique<TipSubject>(options);
}

}  // namespace keepout::app
