// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "bench/speed/speed.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/solvers/registry.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

constexpr std::string_view their_index = "fcl_obbrss", their_solver = "nlopt_slsqp";

/// Twice the last-level cache. A virtual machine may report the cache of the whole host. [bytes]
std::size_t more_than_caches_hold() {
  constexpr long least = 64L << 20, most = 256L << 20;
  return static_cast<std::size_t>(std::clamp(2 * sysconf(_SC_LEVEL3_CACHE_SIZE), least, most));
}

/// Repeats the work; reads the clock once each time.
template <class Work>
void fill(TimeHistogram& histogram, std::size_t times, Work&& work) {
  using std::chrono::nanoseconds;
  BenchClock::time_point last = BenchClock::now();
  for (std::size_t i = 0; i < times; ++i) {
    work(i, last);
    const BenchClock::time_point now = BenchClock::now();
    const auto spent = std::chrono::duration_cast<nanoseconds>(now - last).count();
    histogram.add(static_cast<std::uint64_t>(spent));
    last = now;
  }
}

}  // namespace

void measure_paper_steps(SpeedRun& run) {
  const IndexedMesh& on = run.bunny;
  const std::vector<Motion> motions = run.contact(on);
  const auto few = std::span(motions).first(std::min(run.effort.slow_steps, motions.size()));
  run.show("building FCL's tree");
  IndexedMesh fcl{on.mesh, nullptr};
  MeasuredSide theirs;
  if (!index_backends().has(their_index)) theirs.refusal = "this build has no FCL";
  if (!solver_backends().has(their_solver)) theirs.refusal = "this build has no NLopt";
  if (theirs.refusal.empty()) fcl.index = make_index(their_index, on.mesh);

  constexpr std::array demands{std::pair{5.0, 60.0}, std::pair{1.0, 25.0}};
  for (const auto& [radius, least] : demands) {
    run.show("the paper's rule, r = " + trimmed(radius) + " mm");
    MotionConstraint ours = paper(on, radius, "active_set");
    MotionConstraint plain = paper(queried(on), radius, "active_set");
    const MeasuredSide mine =
        time_steps("wide_bvh + active_set", ours, plain, motions, run.effort.passes);
    if (fcl.index) {
      MotionConstraint libraries = paper(fcl, radius, std::string(their_solver));
      const double accuracy = solver_backends().named(their_solver).accuracy;
      theirs = time_steps("FCL's tree + SLSQP", libraries, plain, few, 1, accuracy);
    }
    if (radius == 5.0) run.libraries = theirs;
    run.add(ratio("whole step, paper's rule, r = " + trimmed(radius) + " mm, contact",
                  "(FCL's tree + SLSQP) / ours", at_least(least), theirs, mine));
  }
}

void measure_certified_steps(SpeedRun& run) {
  const IndexedMesh& on = run.bunny;
  constexpr const char* to_the_libraries = "(FCL's tree + SLSQP, paper's rule, r = 5 mm) / ours";
  const MeasuredSide contact = run.contact_side = in_contact(run, on);
  run.add(ratio("certified step in contact, motion .05-.2 mm, margin .2 mm", to_the_libraries,
                at_least(500.0), run.libraries, contact));

  run.show("certified, free space");
  const std::vector<Motion> path = free_motions(on, run.effort.steps, {}, {}, run.random());
  run.free_side = time_certified(run, on, "free space", MotionKind{}.clearance, path);
  run.add(ratio("certified step in free space, 2-20 mm off the surface", to_the_libraries,
                at_least(5000.0), run.libraries, run.free_side));

  run.add(ratio("certified in contact", "margin 5 mm / margin .2 mm", at_most(3.0),
                in_contact(run, on, {.clearance = 5.0}), contact));
  run.add(ratio("certified in contact, margin .2 mm", "motion 1-5 mm / motion .05-.2 mm",
                at_most(3.0), in_contact(run, on, {.shortest = 1.0, .longest = 5.0}), contact));

  constexpr MotionKind hand{.shortest = 1e-3, .longest = 0.05};
  const std::string at_1_khz = "certified at 1 kHz, tool at 1-50 mm/s, margin .2 mm, ";
  constexpr const char* to_longer = "motion .001-.05 mm / motion .05-.2 mm";
  run.add(
      ratio(at_1_khz + "in contact", to_longer, at_most(1.0), in_contact(run, on, hand), contact));
  run.show("certified, free space at 1 kHz");
  const std::vector<Motion> slow = free_motions(on, run.effort.steps, {}, hand, run.random());
  run.add(ratio(at_1_khz + "in free space", to_longer, at_most(1.0),
                time_certified(run, on, "free space, motion 0.001-0.05 mm", hand.clearance, slow),
                run.free_side));
}

void measure_unrelated_states(SpeedRun& run) {
  const IndexedMesh& on = run.bunny;
  run.show("certified, unrelated states");
  const MotionKind kind;
  const std::vector<Motion> motions = held_back_motions(on, run.effort.steps, kind, run.random());
  const auto time_plain = [&](const std::string& name, const IndexedMesh& plain) {
    MotionConstraint guard = certified(plain, kind.clearance);
    return timed("plain form on " + name, motions.size(), run.effort.passes,
                 [&](std::size_t i) { guard.step(motions[i]); });
  };
  const MeasuredSide ours = time_certified(run, on, "ours", kind.clearance, motions);
  MeasuredSide theirs{.refusal = "this build has no FCL"};
  if (index_backends().has(their_index)) {  // FCL has no wide instructions on any target
    theirs = time_plain(std::string(their_index), {on.mesh, make_index(their_index, on.mesh)});
  }
  SpeedRow row = ratio("certified, unrelated states that the surface limits, margin .2 mm",
                       "scalar / ours", at_least(8.0), theirs, ours);
  row.sides.push_back(time_plain("wide_bvh", queried(on)));
  run.add(std::move(row));
}

void measure_concave_sphere(SpeedRun& run) {
  run.bunny = {};  // large meshes need its memory
  run.show("concave sphere");
  constexpr double icosahedron = 52.57;  // its edge, in a sphere of radius 50 [mm]
  const double edge = icosahedron / std::sqrt(static_cast<double>(run.triangles) / 20.0);
  const IndexedMesh sphere =
      with_index(std::make_shared<const Mesh>(in_single_precision(make_concave_sphere(edge))));
  const MotionKind kind;
  const MeasuredSide centre = time_certified(run, sphere, "centre", kind.clearance,
                                             central_motions(run.effort.steps, kind, run.random()));
  run.add(ratio("certified in a concave sphere", "tip at the center / free space", at_most(3.0),
                centre, run.free_side));
  MeasuredSide wall = in_contact(run, sphere);
  wall.name = "wall";
  run.add(ratio("certified in a concave sphere", "tip at the wall / contact", at_most(6.0), wall,
                run.contact_side));
}

void measure_cold_caches(SpeedRun& run) {
  const IndexedMesh& on = run.bunny;
  run.show("certified, cold caches");
  std::vector<Motion> motions = run.contact(on);
  motions.resize(std::min(motions.size(), run.effort.cold_steps));
  MotionConstraint ours = certified(on, MotionKind{}.clearance);
  for (const Motion& motion : motions) ours.step(motion);
  std::vector<unsigned char> other_data(more_than_caches_hold());
  std::vector<double> times;
  for (const Motion& motion : motions) {
    constexpr std::size_t line = 64;
    for (std::size_t i = 0; i < other_data.size(); i += line) ++other_data[i];
    const BenchClock::time_point start = BenchClock::now();
    ours.step(motion);
    times.push_back(microseconds_since(start));
  }
  const MeasuredSide cold{.name = "cold", .us = timing_of(times)};
  const MeasuredSide& warm = run.contact_side;
  SpeedRow row = ratio("certified in contact, caches emptied before each step", "p99 / warm median",
                       at_most(40.0), cold, warm);
  row.figure = std::nullopt;
  if (warm.refusal.empty() && cold.us.p99) row.figure = *cold.us.p99 / warm.us.p50;
  run.add(std::move(row));
}

void measure_steadiness(SpeedRun& run) {
  const IndexedMesh& on = run.bunny;
  run.show("histogram");
  const std::vector<Motion> motions = run.contact(on);
  const std::size_t steps = run.options.speed.histogram_steps;
  MotionConstraint ours = certified(on, MotionKind{}.clearance);
  for (const Motion& motion : motions) ours.step(motion);

  TimeHistogram times, nothing;
  const std::uint64_t faults = page_faults();
  const CallCounts calls = calls_of_this_thread();
  fill(times, steps,
       [&](std::size_t i, BenchClock::time_point) { ours.step(motions[i % motions.size()]); });
  const CallCounts calls_after = calls_of_this_thread();
  const auto add_count = [&](const std::string& what, std::uint64_t count) {
    run.add({.work = "certified in contact, " + grouped(steps) + " steps after warm-up",
             .compared = what,
             .demand = at_most(0.0),
             .unit = "",
             .figure = static_cast<double>(count)});
  };
  add_count("page faults", page_faults() - faults);
  if (counts_calls()) {
    add_count("allocations", calls_after.allocations - calls.allocations);
    add_count("locks", calls_after.locks - calls.locks);
  }

  // An empty loop that waits as often and as long as the median step: its outliers come from the
  // machine.
  const auto median =
      std::chrono::nanoseconds(static_cast<std::int64_t>(times.percentile(0.5).value_or(0.0)));
  fill(nothing, steps, [&](std::size_t, BenchClock::time_point last) {
    while (BenchClock::now() - last < median) {
    }
  });
  run.set_histogram(times, nothing);
}

}  // namespace keepout::app
