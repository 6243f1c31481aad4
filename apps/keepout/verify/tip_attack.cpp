// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "keepout/factory/make_motion_constraint.h"
#include "verify/attack.h"
#include "verify/tip_joints.h"

namespace keepout::app {
namespace {

using oracle::TipVerdict;

// A tip is replaced after this many consecutive steps without a motion.
constexpr int patience = 8;

/// Returns the random numbers of one trajectory, which are independent of all others.
Random random_of(std::uint64_t seed, std::uint64_t trajectory) {
  Random of_seed(seed);
  Random of_trajectory(of_seed.bits() ^ trajectory);
  return Random(of_trajectory.bits());
}

/// Returns true for a failure that no guarantee excludes: the tip was placed on the surface or
/// inside, and the options or the joints allow no way out.
bool is_expected(Status failure, const Setup& setup) noexcept {
  const bool of_joints = failure == Status::ill_posed || failure == Status::infeasible;
  return failure == Status::touching || failure == Status::inside ||
         (setup.joints > 0 && of_joints);
}

/// Returns the record of a breach, or of a step without a motion. `what`: the breach, or the status
/// of the step.
Json incident(std::string_view what, const std::string& mesh, const Scene& scene,
              std::uint64_t trajectory, std::uint64_t cycle, const Setup& setup,
              const Motion& motion, const Step& step, const TipVerdict& verdict) {
  std::vector<double> jacobian, row_matrix, row_bounds;
  if (motion.jacobian) {
    const double* const first = motion.jacobian->data();
    jacobian.assign(first, first + 3 * motion.jacobian->joints());
  }
  if (motion.rows) {
    const auto columns = motion.jacobian ? motion.jacobian->joints() : 3;
    const auto rows = motion.rows->count();
    row_matrix.assign(motion.rows->matrix(), motion.rows->matrix() + rows * columns);
    row_bounds.assign(motion.rows->bounds(), motion.rows->bounds() + rows);
  }
  Json finding{{"what", what},
               {"mesh", mesh},
               {"scene", scene.name()},
               {"trajectory", trajectory},
               {"cycle", cycle},
               {"start", setup.start},
               {"route", name(setup.route)},
               {"longest_step", setup.longest_step},
               {"joints", setup.joints},
               {"has_limits", setup.has_limits},
               {"start_tip", json_of(setup.tip)},
               {"inside", inside_names[static_cast<std::size_t>(setup.inside)]},
               {"tip", json_of(motion.tip)},
               {"desired", json_of(motion.desired)},
               {"motion", json_of(step.motion)},
               {"status", name(step.status)},
               {"jacobian", jacobian},      // 3 x n, column by column; empty without Jacobian
               {"row_matrix", row_matrix},  // of the extra rows, row by row
               {"row_bounds", row_bounds},
               {"distance", verdict.distance},
               {"allowed", verdict.threshold},
               {"tau", verdict.tolerance},
               {"triangle", verdict.triangle}};
  for (const auto& option : step_options) {
    std::visit([&](const auto& value) { finding[std::string(option.name)] = value; },
               option.get(setup.options));
  }
  return finding;
}

/// A tip, its operator and its judge.
struct Tip {
  Tip(Scene& scene, Guard& guard, Random& random)
      : setup(draw_setup(scene, random)),
        attacker(scene, random, setup.route, setup.longest_step, required_clearance(setup.options)),
        joints(setup, random),
        judge(scene.judged(), setup.options,
              setup.inside == Inside::escape && scene.has_sides() && setup.joints == 0, setup.tip),
        place(setup.tip) {
    guard.begin(setup.options, setup.inside);
  }

  Setup setup;
  Attacker attacker;
  TipJoints joints;
  oracle::TipJudge judge;
  Vec3 place;
  int failures = 0;  // consecutive steps without a motion
};

class TipAttack final : public Attack {
 public:
  /// Attacks on `arenas[arena]`.
  TipAttack(const Campaign& campaign, std::span<const Arena> arenas, std::size_t arena,
            Findings& findings)
      : Attack({.mesh = arenas[arena].mesh}),
        campaign_(campaign),
        arenas_(arenas),
        arena_(arena),
        findings_(findings),
        trajectories_(trajectory_count(campaign.steps, steps_of_a_trajectory)),
        next_(from(campaign.shard.index - 1)) {}

  std::uint64_t begin() override {
    tip_.reset();
    if (is_done()) return 0;
    if (scenes_.empty()) {
      scenes_ = arenas_[arena_].load();
      if (scenes_.empty()) return 0;
      for (const Scene& scene : scenes_) guards_.push_back(campaign_.make_guard(scene));
      row.triangles = scenes_.front().mesh()->triangle_count();
    }
    ++row.starts;
    trajectory_ = next_;
    next_ = from(next_ + campaign_.shard.count);
    random_ = random_of(campaign_.seed, trajectory_);
    random_.bits();  // skips the number that chose the arena
    // The first scene is at the origin. The others are used in an eighth of the trajectories.
    const bool is_elsewhere = scenes_.size() > 1 && random_.uniform() < 0.125;
    scene_ = is_elsewhere ? 1 + random_.below(scenes_.size() - 1) : 0;
    return std::min(steps_of_a_trajectory, campaign_.steps - trajectory_ * steps_of_a_trajectory);
  }

  bool cycle(std::uint64_t number) override {
    row.now = trajectory_ * steps_of_a_trajectory + number + 1;
    Scene& scene = scenes_[scene_];
    Guard& guard = *guards_[scene_];
    if (!tip_) {
      tip_.emplace(scene, guard, random_);
      ++row.tips;
    }
    Motion motion{.tip = tip_->place, .desired = tip_->attacker.next(tip_->place).linear};
    tip_->joints.attach(motion);
    const Step step = guard.step(motion);
    const TipVerdict verdict = tip_->judge.judge(motion, step);
    add(verdict, step.status);

    const auto note = [&](std::string_view what, Json& incidents, std::size_t most) {
      if (incidents.size() >= most) return;
      incidents.push_back(
          incident(what, row.mesh, scene, trajectory_, number, tip_->setup, motion, step, verdict));
    };
    if (!step.ok() && !is_expected(step.status, tip_->setup)) {
      note(name(step.status), findings_.anomalies, most_anomalies);
    }
    if (verdict.breach) note(name(*verdict.breach), findings_.breaches, most_breaches);
    tip_->failures = step.ok() ? 0 : tip_->failures + 1;
    tip_->place += step.motion;
    if (verdict.breach || tip_->failures >= patience) tip_.reset();
    return true;
  }

  bool is_done() const override { return next_ >= trajectories_; }

 private:
  /// Returns the first trajectory of the shard on this mesh, at or after the given one. A list of
  /// all would take memory in proportion to the steps of the campaign.
  std::uint64_t from(std::uint64_t trajectory) const noexcept {
    while (trajectory < trajectories_ &&
           random_of(campaign_.seed, trajectory).below(arenas_.size()) != arena_) {
      trajectory += campaign_.shard.count;
    }
    return trajectory;
  }

  void add(const TipVerdict& verdict, Status status) {
    ++row.cycles;
    ++row.statuses[static_cast<std::size_t>(status)];
    row.led_out += verdict.was_led_out ? 1 : 0;
    if (verdict.breach) row.count(*verdict.breach);
    if (verdict.was_led_out || !(verdict.tolerance > 0.0)) return;
    const double beyond = verdict.distance - required_clearance(tip_->setup.options);
    row.least_beyond = std::min(row.least_beyond, beyond);
    row.least_in_tau = std::min(row.least_in_tau, beyond / verdict.tolerance);
  }

  const Campaign& campaign_;
  std::span<const Arena> arenas_;
  std::size_t arena_;
  Findings& findings_;
  std::uint64_t trajectories_;    // of all meshes and shards
  std::uint64_t next_;            // the number of the next trajectory on this mesh
  std::uint64_t trajectory_ = 0;  // the current one
  std::vector<Scene> scenes_;
  std::vector<std::unique_ptr<Guard>> guards_;
  std::size_t scene_ = 0;  // the current one
  Random random_{0};
  std::optional<Tip> tip_;
};

/// Returns valid options, which the constraint has until the first tip sets its own.
MotionConstraintSettings any_settings(const Scene& scene) {
  const double radius = scene.mean_edge();
  return {.options = {.radius = radius,
                      .margin = scene.judged().longest_edge() + least_distance_kept(scene, radius)},
          .capacity = {.nodes = most_nodes}};
}

}  // namespace

Guard::Guard(const Scene& scene)
    : constraint_(make_motion_constraint(scene.mesh(), scene.shared_index(), any_settings(scene))) {
}

void Guard::begin(const StepOptions& options, Inside inside) {
  constraint_.set_options(options);
  sides_ = inside == Inside::escape ? SideWatch() : SideWatch::off();
}

Step Guard::step(const Motion& motion) noexcept { return constraint_.step(motion, sides_); }

Attacks attacks_on_tips(const Campaign& campaign, std::span<const Arena> arenas,
                        Findings& findings) {
  Attacks attacks;
  for (std::size_t arena = 0; arena < arenas.size(); ++arena) {
    attacks.push_back(std::make_unique<TipAttack>(campaign, arenas, arena, findings));
  }
  return attacks;
}

}  // namespace keepout::app
