// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/parts.h"
#include "bench/speed/families.h"
#include "bench/speed/searcher.h"
#include "bench/speed/stopwatch.h"
#include "keepout/error.h"
#include "keepout/fixtures/poses.h"
#include "number_text.h"

namespace keepout::app {
namespace {

constexpr double farthest_off = 2.0;  // from the surface [mm]

std::vector<Vec3> places_near(const Mesh& mesh, std::size_t count, Random random) {
  std::vector<Vec3> places = surface_points(mesh, count, 0.0, random);
  for (Vec3& place : places) {
    place += random.uniform(0.0, farthest_off) * random.direction();
  }
  return places;
}

/// An index that ours is set against, and how many times as long it must take.
struct Rival {
  std::string_view index;
  std::string_view name;
  double at_5_mm, at_1_mm;
};

constexpr std::array rivals{Rival{"fcl_obbrss", "FCL's tree", 38.0, 10.0},
                            Rival{"embree", "Embree", 10.0, 5.0}};

/// What one index takes; missing where an answer is wrong.
struct Queried {
  std::optional<MeasuredSide> answer = {};       // candidates by the engine's kernel
  std::optional<MeasuredSide> lean_answer = {};  // by the least code; the same for exact indices
};

/// Also for the table of all of them.
Queried measure(SpeedRun& run, const std::string& name, const Mesh& mesh, const SpatialIndex& index,
                const Question& question, int passes) {
  Searcher searcher(mesh, index, question.radius());
  for (const Decider decider : {Decider::kernel, Decider::lean_test}) {
    if (question.wrong_answers(searcher, decider) > 0) return {};
  }
  const std::span<const Vec3> places = question.places();
  const auto time_answers = [&](std::string side, Decider decider) {
    return timed(std::move(side), places.size(), passes,
                 [&](std::size_t i) { searcher.answer(places[i], decider); });
  };
  const MeasuredSide candidates =
      timed(name, places.size(), passes, [&](std::size_t i) { searcher.collect(places[i]); });
  Queried queried{.answer = candidates, .lean_answer = candidates};
  if (!index.is_exact()) {
    queried.answer = time_answers(name, Decider::kernel);
    queried.lean_answer = time_answers(name + ", lean exact test", Decider::lean_test);
  }
  run.record.queries.push_back({.index = name,
                                .radius = question.radius(),
                                .found_mean = question.found_mean(),
                                .candidates = candidates.us,
                                .answer = queried.answer->us,
                                .lean_answer = queried.lean_answer->us});
  return queried;
}

void add_rival(SpeedRun& run, const Rival& rival, double radius, const Queried& theirs,
               const Queried& ours) {
  SpeedRow row = ratio("sphere query r = " + trimmed(radius) + " mm, random",
                       std::string(rival.name) + " / wide_bvh",
                       at_least(radius == 5.0 ? rival.at_5_mm : rival.at_1_mm), theirs.lean_answer,
                       ours.answer);
  if (theirs.answer) row.sides.push_back(*theirs.answer);
  if (!theirs.answer) row.remark = "not timed: its triangles are not those of wide_bvh";
  run.add(std::move(row));
}

}  // namespace

void measure_sphere_queries(SpeedRun& run, const IndexedMesh& on) {
  constexpr std::array radii{5.0, 1.0};
  const int passes = run.settings.effort.passes;
  const std::vector<Vec3> places = places_near(*on.mesh, run.settings.effort.queries, run.random());
  std::vector<Question> questions;
  std::vector<Queried> ours;
  for (const double radius : radii) {
    run.show("sphere queries, r = " + trimmed(radius) + " mm");
    const Question& question = questions.emplace_back(on.mesh, *on.index, radius, places);
    ours.push_back(measure(run, "wide_bvh", *on.mesh, *on.index, question, passes));
  }
  for (const IndexBackend& backend : indices()) {
    if (backend.name == "brute_force" || backend.name == "wide_bvh") continue;
    const std::string name(backend.name);
    run.show("sphere queries, " + name);
    std::unique_ptr<SpatialIndex> index;
    try {
      index = backend.make(on.mesh);
    } catch (const Error&) {
      continue;  // it cannot hold such a mesh
    }
    const auto rival = std::ranges::find(rivals, backend.name, &Rival::index);
    const bool is_rival = rival != rivals.end();
    for (std::size_t r = 0; r < radii.size(); ++r) {
      const Queried theirs =
          measure(run, name, *on.mesh, *index, questions[r], is_rival ? passes : 1);
      if (is_rival) add_rival(run, *rival, radii[r], theirs, ours[r]);
    }
  }
}

}  // namespace keepout::app
