// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory.h"

#include <optional>
#include <utility>

#include "judge.h"
#include "path.h"
#include "setup.h"

namespace keepout::app {
namespace {

// Steps without a motion, one after the other, until a tip is given up.
constexpr int patience = 8;

/// A tip, and who guides, guards and judges it.
struct Attempt {
  Attempt(Scene& scene, Guard& guard, Random& random)
      : setup(draw_setup(scene, random)),
        path(scene, random, setup),
        joints(setup, random),
        judge(scene, setup),
        tip(setup.tip) {
    guard.begin(setup.options, setup.inside);
  }

  Setup setup;
  Path path;
  Joints joints;
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

}  // namespace

void run_trajectory(Scene& scene, Guard& guard, std::uint64_t number, std::uint64_t steps,
                    Random& random, Tally& tally, Findings& findings) {
  ++tally.trajectories;
  std::optional<Attempt> attempt;
  for (std::uint64_t cycle = 0; cycle < steps; ++cycle) {
    if (!attempt) {
      attempt.emplace(scene, guard, random);
      ++tally.tips;
    }
    Motion motion{.tip = attempt->tip, .desired = attempt->path.next(attempt->tip)};
    attempt->joints.attach(motion);
    const Step step = guard.step(motion);
    const Verdict verdict = attempt->judge.judge(motion, step);
    tally.add(verdict, step.status, attempt->setup.options.margin);

    const auto note = [&](std::string_view what, std::vector<Incident>& incidents,
                          std::size_t most) {
      if (incidents.size() >= most) return;
      incidents.push_back(
          make_incident(std::string(what), scene, attempt->setup, motion, step, verdict));
      incidents.back().trajectory = number;
      incidents.back().cycle = cycle;
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

}  // namespace keepout::app
