// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// From a file to the first step: what each part of the way takes.
#include <benchmark/benchmark.h>

#include <memory>

#include "keepout/fixtures/real_mesh.h"
#include "keepout/index/pd_tree.h"
#include "keepout/mesh/adjacency.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/mesh/weld.h"

namespace keepout {
namespace {

constexpr const char* skull = "skull_1m";

void read(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(read_binary_stl(fixture_path(skull)));
}

void weld_vertices(benchmark::State& state) {
  const Surface soup = read_binary_stl(fixture_path(skull));
  for (auto _ : state) {
    state.PauseTiming();
    Surface copy = soup;
    state.ResumeTiming();
    benchmark::DoNotOptimize(weld(std::move(copy)));
  }
}

std::shared_ptr<const Mesh> skull_mesh() {
  return std::make_shared<const Mesh>(weld(read_binary_stl(fixture_path(skull))));
}

void adjacency(benchmark::State& state) {
  const auto mesh = skull_mesh();
  for (auto _ : state) benchmark::DoNotOptimize(Adjacency(*mesh));
}

void pd_tree(benchmark::State& state) {
  const auto mesh = skull_mesh();
  for (auto _ : state) benchmark::DoNotOptimize(PdTree(mesh));
  state.counters["bytes_per_triangle"] =
      static_cast<double>(PdTree(mesh).memory()) / static_cast<double>(mesh->triangle_count());
}

void all_of_it(benchmark::State& state) {
  for (auto _ : state) {
    const auto mesh = skull_mesh();
    benchmark::DoNotOptimize(Adjacency(*mesh));
    benchmark::DoNotOptimize(PdTree(mesh));
  }
}

BENCHMARK(read)->Name("load/read/skull_1m")->Unit(benchmark::kMillisecond);
BENCHMARK(weld_vertices)->Name("load/weld/skull_1m")->Unit(benchmark::kMillisecond);
BENCHMARK(adjacency)->Name("load/adjacency/skull_1m")->Unit(benchmark::kMillisecond);
BENCHMARK(pd_tree)->Name("load/pd_tree/skull_1m")->Unit(benchmark::kMillisecond);
BENCHMARK(all_of_it)->Name("load/all/skull_1m")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace keepout
