// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/measure.h"

#include <bit>
#include <chrono>
#include <string>

#include "number_text.h"

namespace keepout::app {
namespace {

using Clock = std::chrono::steady_clock;

/// So many steps are asked for whatever the time, that medians and 99.9 % compare; unless it takes
/// so many times the time that there is.
constexpr std::size_t enough_steps = 1000;
constexpr double patience = 4.0;

/// So many that even the slowest has a median.
constexpr std::size_t fewest_steps = 5;

double microseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::micro>(duration).count();
}

/// Adds up what a solver does; a step may ask it more than once.
class CountingSolver final : public Solver {
 public:
  explicit CountingSolver(Solver& solver) : solver_(solver) {}

  void reserve(int variables, int rows) override { solver_.reserve(variables, rows); }

  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override {
    const SolveStatus status = solver_.solve(problem, solution);
    iterations_ += static_cast<std::size_t>(solution.iterations);
    return status;
  }

  std::size_t iterations() const { return iterations_; }

 private:
  Solver& solver_;
  std::size_t iterations_ = 0;
};

/// Of all bits of all answers (FNV-1a).
class AnswerHash {
 public:
  void add(const Answer& answer) {
    add(static_cast<std::uint64_t>(answer.status));
    for (const double x : answer.motion) add(std::bit_cast<std::uint64_t>(x + 0.0));  // -0 is 0
  }

  std::uint64_t value() const { return value_; }

 private:
  void add(std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) {
      value_ = (value_ ^ ((word >> (8 * byte)) & 0xFF)) * 0x100000001B3;
    }
  }

  std::uint64_t value_ = 0xCBF29CE484222325;
};

/// A wrong answer; one that is withheld is not.
bool is_wrong(const Answer& got, const Answer& expected, double accuracy, const Motion& motion,
              const RuleSetting& setting) {
  if (accuracy == 0.0) return !(got == expected);
  if (!is_ok(got.status) || setting.proves_motions()) return false;
  if (!is_ok(expected.status)) return true;
  return !((got.motion - expected.motion).norm() <= accuracy * motion.desired.norm());
}

/// Right, but short of the reference by more than a thousandth of the motion.
bool is_worse(const Answer& got, const Answer& expected, const Motion& motion) {
  return is_ok(got.status) && is_ok(expected.status) &&
         (got.motion - motion.desired).norm() >
             (expected.motion - motion.desired).norm() + 1e-3 * motion.desired.norm();
}

/// The number of steps that there was time for; the row says whether they were right.
std::size_t verify(const Pipeline& pipeline, std::span<const Motion> motions, Reference& reference,
                   double accuracy, double seconds, BenchmarkRow& row) {
  CountingSolver solver(pipeline.solver);
  const Pipeline watched{pipeline.mesh, pipeline.index, pipeline.rule,
                         solver,        pipeline.work,  pipeline.setting};
  AnswerHash hash;
  std::size_t candidates = 0, hits = 0, planes = 0, unsolved = 0, worse = 0, wrong = 0, count = 0;
  Clock::duration spent{};
  for (; count < motions.size(); ++count) {
    const double limit = count < enough_steps ? patience * seconds : seconds;
    if (count >= fewest_steps && microseconds(spent) > 1e6 * limit) break;
    const Clock::time_point start = Clock::now();
    const Answer got = watched.ask(motions[count]);
    spent += Clock::now() - start;
    candidates += pipeline.work.candidates.size();
    hits += pipeline.work.hits.size();
    planes += pipeline.work.planes.size();
    hash.add(got);
    if (!is_ok(got.status)) ++unsolved;
    const Answer& expected = reference.answer(count);
    if (is_wrong(got, expected, accuracy, motions[count], pipeline.setting)) ++wrong;
    if (is_worse(got, expected, motions[count])) ++worse;
  }
  const auto mean = [&](std::size_t sum) {
    return static_cast<double>(sum) / static_cast<double>(count);
  };
  row.queries = count;
  row.candidates_mean = mean(candidates);
  row.hits_mean = mean(hits);
  row.planes_mean = mean(planes);
  row.iterations_mean = mean(solver.iterations());
  row.unsolved_share = mean(unsolved);
  row.worse_share = mean(worse);
  row.hash = hash.value();
  row.verified = wrong == 0;
  if (wrong > 0) {
    row.remark = "not timed: " + grouped(wrong) + " of " + counted(count, "step") +
                 " are not those of the reference";
  }
  return count;
}

Timing time_collect(const Pipeline& pipeline, std::span<const Ball> balls) {
  std::vector<double> times;
  times.reserve(balls.size());
  for (const Ball& ball : balls) {
    pipeline.work.candidates.clear();
    const Clock::time_point start = Clock::now();
    pipeline.index.collect(ball, pipeline.work.candidates);
    times.push_back(microseconds(Clock::now() - start));
  }
  return timing_of(times);
}

void time_steps(const Pipeline& pipeline, std::span<const Motion> motions, BenchmarkRow& row) {
  std::vector<double> query, activate, solve, all;
  for (std::vector<double>* times : {&query, &activate, &solve, &all}) {
    times->reserve(motions.size());
  }
  for (const Motion& motion : motions) {
    StageTimes times;
    pipeline.ask(motion, times);
    query.push_back(1e-3 * static_cast<double>(times.query));
    activate.push_back(1e-3 * static_cast<double>(times.activation));
    solve.push_back(1e-3 * static_cast<double>(times.solve));
    all.push_back(1e-3 * static_cast<double>(times.total()));
  }
  row.query = timing_of(query);
  row.activate = timing_of(activate);
  row.solve = timing_of(solve);
  row.step = timing_of(all);
}

}  // namespace

void measure(const Pipeline& pipeline, std::span<const Motion> motions, Reference& reference,
             double accuracy, double seconds, BenchmarkRow& row) {
  if (!reference.is_found_by(pipeline.index)) {
    row.remark = "not timed: the triangles are not those of brute force";
    return;
  }
  const std::size_t count = verify(pipeline, motions, reference, accuracy, seconds, row);
  if (!row.verified) return;
  row.collect = time_collect(pipeline, reference.balls().first(count));
  time_steps(pipeline, motions.first(count), row);
}

}  // namespace keepout::app
