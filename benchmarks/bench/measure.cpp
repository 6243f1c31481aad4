// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/bench.h"
#include "compare/compare.h"
#include "keepout/error.h"
#include "keepout/index/brute_force.h"
#include "record/json_parts.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

/// Returns the number of motions for brute force, which needs about 0.1 s for each on a million
/// triangles.
std::size_t sample_count_on(const Mesh& mesh) {
  constexpr std::size_t few = 2, many = 8, much_work = 8'000'000;
  return std::clamp(much_work / mesh.triangle_count(), few, many);
}

/// Many readers of JSON do not keep whole numbers of 64 bits.
std::string hexadecimal(std::uint64_t value) {
  return formatted("%016llx", static_cast<unsigned long long>(value));
}

/// Returns a hash of all bits of a query's result.
std::uint64_t hash_of(std::span<const Hit> hits) {
  BitHash hash;
  for (const Hit& hit : hits) {
    hash.add(std::uint64_t{hit.triangle});
    for (const double x : hit.closest.offset) hash.add(x);
    hash.add(hit.closest.distance);
    hash.add(static_cast<std::uint64_t>(hit.closest.feature));
  }
  return hash.value();
}

/// The times of each query and step. [µs]
struct TimesOfStages {
  std::vector<double> collect, exact, query, step, step_query, activate, solve;
};

double microseconds(BenchClock::duration time) {
  return std::chrono::duration<double, std::micro>(time).count();
}

/// Returns the median of each 200 consecutive steps: four strokes of contact_motions(). Steps of a
/// stroke are alike, but strokes are independent.
std::vector<double> medians_of(std::span<const double> steps) {
  constexpr std::size_t part = 200;
  std::vector<double> medians;
  for (; steps.size() >= part; steps = steps.subspan(part)) {
    std::vector<double> times(steps.begin(), steps.begin() + part);
    medians.push_back(timing_of(times).p50);
  }
  return medians;
}

/// At least this many steps, so that medians and 99.9 % percentiles compare; but at most `patience`
/// times the given time.
constexpr std::size_t enough_steps = 1000;
constexpr double patience = 4.0;

/// At least this many, so that even the slowest has a median.
constexpr std::size_t fewest_steps = 5;

/// Returns true for a wrong answer; a missing answer is not wrong.
bool is_wrong(const Answer& got, const Answer& expected, double accuracy, const Motion& motion,
              bool proven) {
  if (accuracy == 0.0) return !(got == expected);
  if (!is_ok(got.status) || proven) return false;
  if (!is_ok(expected.status)) return true;
  return !((got.motion - expected.motion).norm() <= accuracy * motion.desired.norm());
}

/// Returns true if a right motion falls short of the reference by more than a thousandth.
bool is_worse(const Answer& got, const Answer& expected, const Motion& motion) {
  return is_ok(got.status) && is_ok(expected.status) &&
         (got.motion - motion.desired).norm() >
             (expected.motion - motion.desired).norm() + 1e-3 * motion.desired.norm();
}

/// Makes as many steps as there is time for.
std::vector<Answer> ask_by_stages(MotionConstraint& constraint, std::span<const Motion> motions,
                                  double seconds, const StopSignal& stop, TimesOfStages& times) {
  std::vector<Answer> answers;
  double spent = 0.0;  // [us]
  for (const Motion& motion : motions) {
    const double limit = answers.size() < enough_steps ? patience * seconds : seconds;
    if ((answers.size() >= fewest_steps && spent > 1e6 * limit) || stop.has_come()) break;
    StageTimes stages;  // [ns]
    answers.push_back(constraint.step(motion, stages));
    times.step_query.push_back(1e-3 * static_cast<double>(stages.query));
    times.activate.push_back(1e-3 * static_cast<double>(stages.activation));
    times.solve.push_back(1e-3 * static_cast<double>(stages.solve));
    spent += 1e-3 * static_cast<double>(stages.total());
  }
  return answers;
}

/// Makes all steps, as a control loop does.
std::vector<Answer> ask(MotionConstraint& constraint, std::span<const Motion> motions,
                        const StopSignal& stop, TimesOfStages& times, double& planes_mean) {
  std::vector<Answer> answers;
  std::size_t planes = 0;
  for (const Motion& motion : motions) {
    if (stop.has_come()) break;
    const BenchClock::time_point start = BenchClock::now();
    const Step step = constraint.step(motion);
    times.step.push_back(microseconds_since(start));
    answers.push_back(step);
    planes += step.planes.size();
  }
  planes_mean = static_cast<double>(planes) / static_cast<double>(motions.size());
  return answers;
}

/// Returns the number of wrong answers; writes the figures of all answers into the row.
std::size_t judge(std::span<const Answer> answers, std::span<const Motion> motions,
                  Reference& reference, double accuracy, BenchmarkRow& row) {
  BitHash hash;
  std::size_t unsolved = 0, worse = 0, wrong = 0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Answer& got = answers[i];
    const Answer& expected = reference.answer(i);
    hash.add(static_cast<std::uint64_t>(got.status));
    for (const double x : got.motion) hash.add(x);
    if (std::has_single_bit(i + 1)) {
      row["hashes_of_first"][std::to_string(i + 1)] = hexadecimal(hash.value());
    }
    if (!is_ok(got.status)) ++unsolved;
    if (is_wrong(got, expected, accuracy, motions[i], reference.proves_motions())) ++wrong;
    if (is_worse(got, expected, motions[i])) ++worse;
  }
  const auto count = static_cast<double>(answers.size());
  row["unsolved_share"] = static_cast<double>(unsolved) / count;
  row["worse_share"] = static_cast<double>(worse) / count;
  row["hash"] = hexadecimal(hash.value());
  return wrong;
}

/// Returns the number of queries with another result than the reference. All indices do the same
/// work, whatever they have computed already: candidates, exact test, closest points, sorting.
std::size_t ask_for_triangles(const SpatialIndex& index, std::size_t count, Reference& reference,
                              const StopSignal& stop, TimesOfStages& times, BenchmarkRow& row) {
  // Before any is timed, so that caches are the same for the first index as for the last.
  std::vector<std::uint64_t> expected;
  for (std::size_t i = 0; i < count; ++i) expected.push_back(reference.hits_hash(i));
  std::size_t candidates = 0, hits = 0, reaching = 0, wrong = 0;
  for (std::size_t i = 0; i < count && !stop.has_come(); ++i) {
    const Ball& ball = reference.balls()[i];
    reference.candidates.clear();
    reference.hits.clear();
    const BenchClock::time_point start = BenchClock::now();
    index.collect(ball, reference.candidates);
    const BenchClock::time_point collected = BenchClock::now();
    refine(reference.mesh(), ball, reference.candidates.view(), reference.hits);
    const BenchClock::time_point refined = BenchClock::now();
    times.collect.push_back(microseconds(collected - start));
    times.exact.push_back(microseconds(refined - collected));
    times.query.push_back(microseconds(refined - start));
    candidates += reference.candidates.size();
    hits += reference.hits.size();
    reaching += reference.hits.empty() ? 0 : 1;
    wrong += hash_of(reference.hits.view()) == expected[i] ? 0 : 1;
  }
  row["candidates_mean"] = static_cast<double>(candidates) / static_cast<double>(count);
  row["hits_mean"] = static_cast<double>(hits) / static_cast<double>(count);
  row["reaching_share"] = static_cast<double>(reaching) / static_cast<double>(count);
  return wrong;
}

}  // namespace

Reference::Reference(std::shared_ptr<const SpatialIndex> right, std::shared_ptr<const Mesh> mesh,
                     const MotionConstraintSettings& settings, std::span<const Motion> motions)
    : candidates(std::min(settings.capacity.triangles, mesh->triangle_count())),
      hits(candidates.capacity()),
      guard_(make_motion_constraint(mesh, std::move(right), settings)),
      proves_motions_(settings.activation == "certified"),
      motions_(motions) {
  const auto brute_force = std::make_shared<const BruteForce>(mesh);
  MotionConstraint exhaustive = make_motion_constraint(std::move(mesh), brute_force, settings);
  for (const Motion& motion : motions_) balls_.push_back(guard_.region(motion));
  const std::size_t sample_count = sample_count_on(guard_.mesh());
  for (std::size_t s = 0; s < sample_count; ++s) {
    const std::size_t motion = s * motions_.size() / sample_count;
    const std::span<const Hit> found = hits_of(*brute_force, balls_[motion]);
    samples_.push_back({motion, {found.begin(), found.end()}});
    fits_ = fits_ && !candidates.overflowed();
    if (!fits_) return;
    const Answer expected = exhaustive.step(motions_[motion]);
    if (Answer(guard_.step(motions_[motion])) != expected) {
      throw Error(
          "the steps of the reference are not those of brute force: this is a bug in "
          "keepout; please report it");
    }
  }
  if (!is_found_by(guard_.index())) {
    throw Error("the reference's index misses triangles: please report it");
  }
}

const Answer& Reference::answer(std::size_t motion) {
  while (answers_.size() <= motion) answers_.push_back(guard_.step(motions_[answers_.size()]));
  return answers_[motion];
}

std::uint64_t Reference::hits_hash(std::size_t motion) {
  while (hits_hashes_.size() <= motion) {
    hits_hashes_.push_back(hash_of(hits_of(guard_.index(), balls_[hits_hashes_.size()])));
  }
  return hits_hashes_[motion];
}

bool Reference::is_found_by(const SpatialIndex& index) {
  return std::ranges::all_of(samples_, [&](const Sample& sample) {
    return std::ranges::equal(hits_of(index, balls_[sample.motion]), sample.hits, is_same);
  });
}

std::span<const Hit> Reference::hits_of(const SpatialIndex& index, const Ball& ball) {
  candidates.clear();
  hits.clear();
  index.collect(ball, candidates);
  refine(mesh(), ball, candidates.view(), hits);
  return hits.view();
}

void measure(MotionConstraint& constraint, double accuracy, std::span<const Motion> motions,
             Reference& reference, double seconds, const StopSignal& stop, BenchmarkRow& row) {
  if (!reference.is_found_by(constraint.index())) {
    row["remark"] = "not timed: the triangles are not those of brute force";
    row["wrong"] = true;
    return;
  }
  TimesOfStages times;
  const std::vector<Answer> staged = ask_by_stages(constraint, motions, seconds, stop, times);
  const std::span<const Motion> asked = motions.first(staged.size());
  double planes_mean = 0.0;
  const std::vector<Answer> answers = ask(constraint, asked, stop, times, planes_mean);
  if (stop.has_come()) return;
  row["queries"] = asked.size();
  row["planes_mean"] = planes_mean;
  std::size_t wrong = judge(answers, asked, reference, accuracy, row);
  // The same constraint made these steps twice, so a difference is an error.
  for (std::size_t i = 0; i < asked.size(); ++i) wrong += staged[i] == answers[i] ? 0 : 1;
  const std::size_t missed =
      ask_for_triangles(constraint.index(), asked.size(), reference, stop, times, row);
  if (stop.has_come()) return;
  if (missed > 0) {
    row["remark"] = "not timed: " + grouped(missed) + " of " + grouped(asked.size()) +
                    " queries do not find what the reference finds";
  }
  if (wrong > 0) {
    row["remark"] = "not timed: " + grouped(wrong) + " of " + counted(asked.size(), "step") +
                    " are not those of the reference";
  }
  row["wrong"] = wrong + missed > 0;
  if (row["wrong"]) return;
  row["verified"] = true;
  row["collect_us"] = timing_of(times.collect);
  row["exact_us"] = timing_of(times.exact);
  row["query_us"] = timing_of(times.query);
  row["step_medians_us"] = medians_of(times.step);
  const Timing step = timing_of(times.step);
  row["step_us"] = step;
  if (step.p50 > 0.0) row["rate_khz"] = 1e3 / step.p50;
  if (constraint.makes_queries()) row["step_query_us"] = timing_of(times.step_query);
  row["activate_us"] = timing_of(times.activate);
  row["solve_us"] = timing_of(times.solve);
  // Without hits the median is meaningless, and a solver that gives up early only looks fast.
  if (row["reaching_share"] < 0.5) {
    row["remark"] = "not ranked: no triangle is in reach of more than half of the motions";
  } else if (row["unsolved_share"] > 0.01) {
    row["remark"] = "not ranked: more than 1 % of the steps have no answer";
  }
}

}  // namespace keepout::app
