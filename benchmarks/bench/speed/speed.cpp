// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/speed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <ostream>
#include <utility>
#include <vector>

#include "keepout/fixtures/real_mesh.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

constexpr unsigned bits_of_a_bin = std::bit_width(TimeHistogram::bins_of_a_doubling) - 1;

constexpr Effort thorough{2000, 20'000, 1500, 500, 3, 3, "skull_1m"};
constexpr Effort quick{200, 1000, 100, 100, 1, 1, "bunny"};

constexpr void (*families[])(SpeedRun&) = {
    measure_sphere_queries, measure_paper_steps, measure_certified_steps, measure_unrelated_states,
    measure_cold_caches,    measure_index_costs, measure_steadiness,      measure_concave_sphere,
    measure_first_step,     measure_large_meshes};

}  // namespace

std::size_t TimeHistogram::bin_of(std::uint64_t ns) noexcept {
  if (ns < 1) return 0;
  const unsigned doubling = static_cast<unsigned>(std::bit_width(ns)) - 1;
  // The three bits after the first one: bins of equal width within a doubling.
  const std::uint64_t place = doubling >= bits_of_a_bin ? ns >> (doubling - bits_of_a_bin)
                                                        : ns << (bits_of_a_bin - doubling);
  return std::min<std::size_t>(doubling * bins_of_a_doubling + (place - bins_of_a_doubling),
                               bins - 1);
}

double TimeHistogram::beginning_of(std::size_t bin) noexcept {
  const auto doubling = static_cast<int>(bin / bins_of_a_doubling);
  const auto place = static_cast<double>(bin % bins_of_a_doubling);
  return std::ldexp(1.0 + place / bins_of_a_doubling, doubling);
}

void TimeHistogram::add(std::uint64_t ns) noexcept {
  ++counts_[bin_of(ns)];
  ++total_;
  longest_ = std::max(longest_, ns);
}

std::optional<double> TimeHistogram::percentile(double share) const noexcept {
  if (total_ == 0) return std::nullopt;
  const auto rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(total_)));
  std::uint64_t passed = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    passed += counts_[bin];
    if (passed >= rank && passed > 0) return beginning_of(bin + 1);
  }
  return beginning_of(bins);
}

Timing least_of(const Timing& one, const Timing& other) {
  const auto lesser = [](const std::optional<double>& a, const std::optional<double>& b) {
    return a && b ? std::min(a, b) : std::nullopt;
  };
  return {.p50 = std::min(one.p50, other.p50),
          .p99 = lesser(one.p99, other.p99),
          .p999 = lesser(one.p999, other.p999),
          .max = std::min(one.max, other.max),
          .samples = one.samples};
}

SpeedRow ratio(std::string work, std::string compared, const Json& demand,
               const MeasuredSide& numerator, const MeasuredSide& denominator) {
  SpeedRow row{.work = std::move(work), .compared = std::move(compared), .demand = demand};
  for (const MeasuredSide* side : {&numerator, &denominator}) {
    if (side->refusal.empty()) row.sides.push_back(*side);
    if (row.remark.empty()) row.remark = side->refusal;
    row.is_wrong = row.is_wrong || side->is_wrong;
  }
  if (row.sides.size() == 2) row.figure = row.sides[0].us.p50 / row.sides[1].us.p50;
  return row;
}

MeasuredSide time_steps(std::string name, MotionConstraint& one, MotionConstraint& other,
                        std::span<const Motion> motions, int passes, double accuracy) {
  if (std::string refusal = disagreement(one, other, motions, accuracy); !refusal.empty()) {
    return {.refusal = std::move(refusal), .is_wrong = true};
  }
  return timed(std::move(name), motions.size(), passes,
               [&](std::size_t i) { one.step(motions[i]); });
}

MeasuredSide time_certified(const SpeedRun& run, const IndexedMesh& on, const std::string& name,
                            double margin, std::span<const Motion> motions) {
  MotionConstraint ours = certified(on, margin);
  MotionConstraint plain = certified(queried(on), margin);
  return time_steps(name, ours, plain, motions, run.effort.passes);
}

MeasuredSide in_contact(SpeedRun& run, const IndexedMesh& on, const MotionKind& kind) {
  const std::string name = "margin " + trimmed(kind.clearance) + " mm, motion " +
                           trimmed(kind.shortest) + "-" + trimmed(kind.longest) + " mm";
  run.show("certified, contact, " + name);
  return time_certified(run, on, name, kind.clearance, run.contact(on, kind));
}

int bench_speed(const BenchOptions& options, std::ostream& out) {
  if (options.triangles.size() > 1) throw Error("--speed: give --triangles one size");
  const std::size_t triangles = options.triangles.empty() ? 1'000'000 : options.triangles.front();
  const Effort& effort = options.speed.quick ? quick : thorough;
  OutputFiles outputs = options.files.open({});
  for (const char* fixture : {"bunny", effort.file}) fixture_path(fixture);  // throws if missing

  const StopSignal stop(keeps_what_is_finished);
  Progress progress("bench --speed", std::size(families));
  SpeedRun run{.options = options,
               .effort = effort,
               .triangles = triangles,
               .progress = progress,
               .stop = stop,
               .out = out,
               .mesh = "bunny, " + counted(triangles, "triangle")};
  const OnCores one(1);
  progress.interrupt();
  print_head(run);
  out.flush();
  if (!one.holds()) out << "The system does not let this process bind itself to one core.\n";
  run.bunny = with_index(bunny_of(triangles));
  try {
    for (const auto measure : families) {
      measure(run);
      progress.advance();
    }
  } catch (const SpeedRun::Stopped&) {
    run.complete = false;
  }
  progress.interrupt();
  print_summary(run);
  write_record(outputs, record_of(run), options.files);
  out << "report: " << options.files.page->string() << '\n';
  if (!run.wrong.empty()) {
    std::cerr << "keepout: wrong answers of " << enumerated(run.wrong, "; ") << '\n';
  }
  if (!run.complete) return exit_interrupted;
  return run.wrong.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace keepout::app
