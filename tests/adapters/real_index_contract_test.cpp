// SPDX-License-Identifier: BSD-3-Clause
// Tests the contract of every index on real anatomy, scans and parts.

#include "keepout/adapters/index_registry.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/testing/index_probes.h"

namespace keepout {
namespace {

class RealIndexContract : public testing::TestWithParam<std::string_view> {};

// One test per mesh serves all indices, because brute force takes most of the time.
TEST_P(RealIndexContract, EveryIndexFindsWhatBruteForceFinds) {
  const std::shared_ptr<const Mesh> mesh = load_mesh(fixture_path(GetParam())).mesh;
  // Brute force examines about the same number of triangles for each mesh.
  const std::size_t points = std::clamp<std::size_t>(1'000'000 / mesh->triangle_count(), 3, 40);
  const std::vector<Probe> asked = probes(*mesh, points);
  for (const IndexBackend& backend : index_backends()) {
    if (backend.name == "brute_force") continue;  // is the reference
    SCOPED_TRACE(backend.name);
    expect_brute_force_sets(*mesh, *backend.make(mesh), asked);
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, RealIndexContract, testing::ValuesIn(real_meshes()), by_name);

}  // namespace
}  // namespace keepout
