// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <optional>
#include <utility>

#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/ompl/joint_planning.h"
#include "plan/judge_joint_path.h"
#include "plan/planning.h"
#include "shared/named_mesh.h"

namespace keepout::app {
namespace {

namespace base = ompl::base;

/// All checkers ask the same guards.
class InstrumentPlanning final : public Planning {
 public:
  InstrumentPlanning(const PlanOptions& options, const std::filesystem::path& mesh)
      : options_(&options),
        on_{{mesh.filename().string(), load_named_mesh(mesh).mesh, "wide_bvh"},
            options.margin,
            robot_named(options.robot)} {}

  const Scene& scene() const override { return on_.scene; }

  std::vector<PlanningProblem> draw() override {
    return draw_problems(on_, options_->problems, options_->seed);
  }

  void open(const PlanningProblem& problem) override {
    guards_ = std::make_shared<InstrumentPool>([this, base = problem.base] {
      return make_instrument_constraint(scene().mesh(), scene().shared_index(),
                                        on_.robot.make(base), {.options = {.margin = on_.margin}});
    });
    oracle_.emplace(on_.scene.tree(), on_.robot.judged(), problem.base);
  }

  base::PlannerPtr planner(const Checker& checker, CheckTimer& timer) override {
    const auto space = std::make_shared<base::SpaceInformation>(joint_space());
    base::MotionValidatorPtr motions;
    if (checker.is_keepouts()) motions = make_motion_validator(space, guards_);
    if (!motions) space->setStateValidityCheckingResolution(checker.resolution);
    set_timed_checkers(space, make_state_validity_checker(space, guards_), std::move(motions),
                       timer);
    return named_planner(options_->planner, space, options_->range);
  }

  Json judge(const Path& path) override {
    if (path.empty()) {
      return {{"motions", nullptr},  {"too_close", nullptr},    {"entering", nullptr},
              {"unproven", nullptr}, {"clearance_mm", nullptr}, {"length_mm", nullptr}};
    }
    const JointPathVerdict verdict = judge_joint_path(*oracle_, *guards_->borrow(), path);
    base::ScopedState<> a(joint_space()), b(a);
    double length = 0.0;
    for (std::size_t i = 1; i < path.size(); ++i) {
      a = path[i - 1];
      b = path[i];
      length += a.distance(b);
    }
    return {{"motions", verdict.motions},
            {"too_close", verdict.too_close},
            {"entering", verdict.entering},
            {"unproven", verdict.unproven},
            {"clearance_mm",
             std::isfinite(verdict.clearance) ? Json(verdict.clearance) : Json(nullptr)},
            {"length_mm", length},
            {"path", path}};
  }

 private:
  base::StateSpacePtr joint_space() const {
    return make_joint_space(guards_->borrow()->instrument());
  }

  const PlanOptions* options_;
  RobotScene on_;
  std::shared_ptr<InstrumentPool> guards_;
  std::optional<oracle::InstrumentOracle> oracle_;
};

}  // namespace

std::vector<std::unique_ptr<Planning>> plannings_of_an_instrument(const PlanOptions& options) {
  std::vector<std::filesystem::path> meshes = options.meshes;
  if (meshes.empty()) meshes = {"airway", "skull"};
  std::vector<std::unique_ptr<Planning>> all;
  for (const auto& mesh : meshes)
    all.push_back(std::make_unique<InstrumentPlanning>(options, mesh));
  return all;
}

}  // namespace keepout::app
