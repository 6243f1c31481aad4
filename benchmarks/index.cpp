// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// How long each index takes to build, and to answer. One that misses a triangle of brute force's is
// not timed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "keepout/adapters/all_indices.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/index/brute_force.h"
#include "keepout/mesh/load_mesh.h"

namespace keepout {
namespace {

constexpr double radii[] = {1.0, 5.0};  // [mm]

/// Places half a millimetre off the skull, the next far from the last: no cache helps.
struct Places {
  std::shared_ptr<const Mesh> mesh = load_mesh(fixture_path("skull_1m")).mesh;
  std::vector<Vec3> points;

  Places() {
    Random random(1);
    points = surface_points(*mesh, 20'000, 0.5, random);
  }
};

const Places& places() {
  static const Places only;
  return only;
}

std::vector<TriangleId> answer(const SpatialIndex& index, const Ball& ball) {
  TriangleBuffer candidates(places().mesh->triangle_count());
  index.collect(ball, candidates);
  std::sort(candidates.begin(), candidates.end());
  return {candidates.begin(), candidates.end()};
}

/// Misses nothing of what brute force finds, on a sample of the places.
bool agrees_with_brute_force(const SpatialIndex& index) {
  const BruteForce oracle(places().mesh);
  for (const double radius : radii) {
    for (std::size_t i = 0; i < places().points.size(); i += 2000) {
      const Ball ball{places().points[i], radius};
      const std::vector<TriangleId> got = answer(index, ball);
      const std::vector<TriangleId> expected = answer(oracle, ball);
      if (!std::includes(got.begin(), got.end(), expected.begin(), expected.end())) return false;
    }
  }
  return true;
}

/// The index that was asked for last, for there is no room for all; null if it is wrong.
const SpatialIndex* checked_index(const IndexBackend& backend) {
  static std::unique_ptr<SpatialIndex> last;
  static std::string name;
  if (name != backend.name) {
    last.reset();
    last = backend.make(places().mesh);
    name = backend.name;
    if (!agrees_with_brute_force(*last)) last.reset();
  }
  return last.get();
}

void build(benchmark::State& state, const IndexBackend& backend) {
  std::size_t memory = 0;
  for (auto _ : state) memory = backend.make(places().mesh)->memory();
  state.counters["bytes_per_triangle"] =
      static_cast<double>(memory) / static_cast<double>(places().mesh->triangle_count());
}

void query(benchmark::State& state, const IndexBackend& backend, double radius) {
  const SpatialIndex* index = checked_index(backend);
  if (index == nullptr) {
    state.SkipWithError("misses triangles that brute force finds");
    return;
  }
  TriangleBuffer candidates(places().mesh->triangle_count());
  std::size_t asked = 0, found = 0;
  for (auto _ : state) {
    candidates.clear();
    index->collect({places().points[asked++ % places().points.size()], radius}, candidates);
    found += candidates.size();
  }
  state.counters["candidates"] = static_cast<double>(found) / static_cast<double>(asked);
}

void register_indices() {
  for (const IndexBackend& backend : all_index_backends()) {
    if (backend.name == "brute_force") continue;  // the oracle: tens of milliseconds a query
    const std::string name = "index/" + std::string(backend.name) + "/skull_1m/";
    benchmark::RegisterBenchmark((name + "build").c_str(), [backend](benchmark::State& state) {
      build(state, backend);
    })->Unit(benchmark::kMillisecond);
    for (const double radius : radii) {
      std::ostringstream full;
      full << name << "r=" << radius;
      benchmark::RegisterBenchmark(full.str().c_str(), [backend, radius](benchmark::State& state) {
        query(state, backend, radius);
      })->Unit(benchmark::kMicrosecond);
    }
  }
}

const bool registered = (register_indices(), true);

}  // namespace
}  // namespace keepout
