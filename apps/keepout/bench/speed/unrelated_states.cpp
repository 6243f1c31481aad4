// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/parts.h"
#include "bench/speed/certified_contact.h"
#include "bench/speed/families.h"
#include "bench/speed/stopwatch.h"
#include "keepout/error.h"
#include "keepout/fixtures/motions.h"

namespace keepout::app {
namespace {

/// All over the surface, and only where it holds the motion back: elsewhere there is hardly
/// anything to time.
std::vector<Motion> held_back(Stepper& rule, const Mesh& mesh, std::size_t count, Random random) {
  constexpr int most_rounds = 50;  // about ten are enough
  std::vector<Motion> motions;
  for (int round = 0; round < most_rounds && motions.size() < count; ++round) {
    for (const Motion& motion : unrelated_motions(mesh, count, {}, random)) {
      if (motions.size() < count && rule.ask(motion).status == Status::limited) {
        motions.push_back(motion);
      }
    }
  }
  if (motions.empty()) throw Error("hardly anywhere does the mesh hold a motion back");
  return motions;
}

/// The plain form on it has no wide instructions anywhere.
const IndexBackend* find_scalar_tree() {
  const auto found = std::ranges::find(indices(), "fcl_obbrss", &IndexBackend::name);
  return found == indices().end() ? nullptr : &*found;
}

}  // namespace

void measure_unrelated_states(SpeedRun& run, const IndexedMesh& on) {
  run.show("certified, unrelated states");
  const Effort& effort = run.settings.effort;
  Stepper plain = certified(on, small_margin, Form::plain);
  const std::vector<Motion> motions = held_back(plain, *on.mesh, effort.steps, run.random());
  const CertifiedSide ours = time_certified(run, on, "ours", small_margin, motions);
  const auto tree = find_scalar_tree();
  const std::unique_ptr<SpatialIndex> scalar_index = tree ? tree->make(on.mesh) : nullptr;
  std::optional<MeasuredSide> theirs;
  if (scalar_index) {
    Stepper scalar(on.mesh, *scalar_index, "certified", "active_set",
                   {.radius = 5.0, .margin = small_margin}, Form::plain);
    theirs = timed("plain form on " + std::string(tree->name), motions.size(), effort.passes,
                   [&](std::size_t i) { scalar.ask(motions[i]); });
  }
  SpeedRow row = ratio("certified, unrelated states that are held back, margin .2 mm",
                       "scalar / ours", at_least(8.0), theirs, ours.side);
  row.sides.push_back(timed("plain form on wide_bvh", motions.size(), effort.passes,
                            [&](std::size_t i) { plain.ask(motions[i]); }));
  run.add(with_remark(std::move(row), ours));
}

}  // namespace keepout::app
