// SPDX-License-Identifier: BSD-3-Clause
#include "campaign.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "keepout/factory/make_motion_constraint.h"
#include "operators/attacker.h"
#include "shared/timing.h"
#include "verify/tip_joints.h"

namespace keepout::app {
namespace {

// Steps without a motion, one after the other, until a tip is given up.
constexpr int patience = 8;

/// The numbers that one trajectory is drawn from: they have nothing to do with those of another.
Random random_of(std::uint64_t seed, std::uint64_t trajectory) {
  Random of_seed(seed);
  Random of_trajectory(of_seed.bits() ^ trajectory);
  return Random(of_trajectory.bits());
}

/// A tip, and who guides, guards and judges it.
struct Attempt {
  Attempt(Scene& scene, Guard& guard, Random& random)
      : setup(draw_setup(scene, random)),
        attacker(scene, random, setup.route, setup.longest_step, required_clearance(setup.options)),
        joints(setup, random),
        judge(scene, setup),
        tip(setup.tip) {
    guard.begin(setup.options, setup.inside);
  }

  Setup setup;
  Attacker attacker;
  TipJoints joints;
  Judge judge;
  Vec3 tip;
  int failures = 0;  // since it last moved
};

/// Nobody promised these a motion: the tip was put down on the surface or inside, where the options
/// allow no way out, or the joints cannot.
bool is_expected(Status failure, const Setup& setup) noexcept {
  const bool of_joints = failure == Status::ill_posed || failure == Status::infeasible;
  return failure == Status::touching || failure == Status::inside ||
         (setup.joints > 0 && of_joints);
}

/// A step that should not have been. `what`: a breach, or the status of a step that found no
/// motion.
Json incident(std::string_view what, const Scene& scene, std::uint64_t trajectory,
              std::uint64_t cycle, const Setup& setup, const Motion& motion, const Step& step,
              const Verdict& verdict) {
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
               {"jacobian", jacobian},      // 3 x n, column by column; empty without one
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

void run_trajectory(Scene& scene, Guard& guard, std::uint64_t number, std::uint64_t steps,
                    Random& random, Tally& tally, Findings& findings) {
  ++tally.trajectories;
  std::optional<Attempt> attempt;
  for (std::uint64_t cycle = 0; cycle < steps; ++cycle) {
    if (!attempt) {
      attempt.emplace(scene, guard, random);
      ++tally.tips;
    }
    Motion motion{.tip = attempt->tip, .desired = attempt->attacker.next(attempt->tip).linear};
    attempt->joints.attach(motion);
    const Step step = guard.step(motion);
    const Verdict verdict = attempt->judge.judge(motion, step);
    tally.add(verdict, step.status, required_clearance(attempt->setup.options));

    const auto note = [&](std::string_view what, Json& incidents, std::size_t most) {
      if (incidents.size() >= most) return;
      incidents.push_back(
          incident(what, scene, number, cycle, attempt->setup, motion, step, verdict));
    };
    if (!step.ok() && !is_expected(step.status, attempt->setup)) {
      note(name(step.status), findings.anomalies, most_anomalies);
    }
    attempt->failures = step.ok() ? 0 : attempt->failures + 1;
    if (verdict.breach) note(name(*verdict.breach), findings.breaches, most_breaches);
    if (verdict.breach || attempt->failures >= patience) {
      attempt.reset();
      continue;
    }
    attempt->tip += step.motion;
  }
}

/// Options follow with each tip: at first any will do that are not refused.
MotionConstraintSettings any_settings(const Scene& scene) {
  const double radius = scene.mean_edge();
  return {.options = {.radius = radius,
                      .margin = scene.longest_edge() + least_distance_kept(scene, radius)},
          .capacity = {.nodes = most_nodes}};
}

}  // namespace

Guard::Guard(const Scene& scene)
    : constraint_(make_motion_constraint(scene.mesh(), scene.shared_index(), any_settings(scene))) {
}

void Guard::begin(const StepOptions& options, Inside inside) {
  constraint_.set_options(options);
  sides_ = inside == Inside::led_out ? SideWatch() : SideWatch::off();
}

Step Guard::step(const Motion& motion) noexcept { return constraint_.step(motion, sides_); }

void Tally::add(const Verdict& verdict, Status status, double kept) noexcept {
  ++steps;
  ++statuses[static_cast<std::size_t>(status)];
  led_out += verdict.was_led_out ? 1 : 0;
  if (verdict.breach) ++breaches[static_cast<std::size_t>(*verdict.breach)];
  if (verdict.was_led_out || !(verdict.tolerance > 0.0)) return;
  const double beyond = verdict.distance - kept;
  least = std::min(least, beyond);
  least_in_tau = std::min(least_in_tau, beyond / verdict.tolerance);
}

std::uint64_t trajectory_count(std::uint64_t steps) noexcept {
  return (steps + steps_of_a_trajectory - 1) / steps_of_a_trajectory;
}

Findings run_campaign(const CampaignSettings& settings, std::span<const Arena> arenas,
                      const Advanced& advanced) {
  std::vector<std::vector<std::uint64_t>> trajectories(arenas.size());
  const std::uint64_t count = trajectory_count(settings.steps);
  for (std::uint64_t n = settings.shard.index - 1; n < count; n += settings.shard.count) {
    trajectories[random_of(settings.seed, n).below(arenas.size())].push_back(n);
  }

  Findings findings;
  Next next = Next::go_on;
  for (std::size_t a = 0; a < arenas.size(); ++a) {
    Tally tally{.mesh = arenas[a].mesh};
    if (!trajectories[a].empty() && next == Next::go_on) {
      std::vector<Scene> scenes = arenas[a].load();
      std::vector<std::unique_ptr<Guard>> guards;
      for (const Scene& scene : scenes) guards.push_back(settings.make_guard(scene));
      tally.triangles = scenes.front().mesh()->triangle_count();
      const BenchClock::time_point start = BenchClock::now();
      for (const std::uint64_t n : trajectories[a]) {
        Random random = random_of(settings.seed, n);
        random.bits();  // which chose the arena
        // The first scene is where the mesh was made; others are a minority.
        const bool is_elsewhere = scenes.size() > 1 && random.uniform() < 0.125;
        const std::size_t s = is_elsewhere ? 1 + random.below(scenes.size() - 1) : 0;
        const std::uint64_t steps =
            std::min(steps_of_a_trajectory, settings.steps - n * steps_of_a_trajectory);
        run_trajectory(scenes[s], *guards[s], n, steps, random, tally, findings);
        next = advanced(steps, tally.mesh);
        if (next == Next::stop) break;
      }
      tally.seconds = microseconds_since(start) * 1e-6;
    }
    findings.meshes.push_back(std::move(tally));
  }
  return findings;
}

}  // namespace keepout::app
