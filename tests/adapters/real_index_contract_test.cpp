// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// The contract of every index on real anatomy, scans and parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "adapters/index_contract.h"
#include "keepout/adapters/load_mesh.h"
#include "keepout/fixtures/real_mesh.h"

namespace keepout {
namespace {

class RealIndexContract
    : public testing::TestWithParam<std::tuple<IndexBackend, std::string_view>> {};

TEST_P(RealIndexContract, FindsWhatBruteForceFinds) {
  const auto& [backend, name] = GetParam();
  const std::shared_ptr<const Mesh> mesh = load_mesh(fixture_path(name)).mesh;
  // About the same number of triangles is looked at for each mesh.
  const std::size_t points = std::clamp<std::size_t>(1'000'000 / mesh->triangle_count(), 3, 40);
  expect_brute_force_sets(mesh, *backend.make(mesh), points);
}

INSTANTIATE_TEST_SUITE_P(Backends, RealIndexContract,
                         testing::Combine(testing::ValuesIn(index_backends()),
                                          testing::ValuesIn(real_meshes())),
                         [](const auto& p) {
                           return std::string(std::get<0>(p.param).name) + "_" +
                                  std::string(std::get<1>(p.param));
                         });

}  // namespace
}  // namespace keepout
