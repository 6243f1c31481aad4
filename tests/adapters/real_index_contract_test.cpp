// SPDX-License-Identifier: BSD-3-Clause
// The contract of every index on real anatomy, scans and parts.

#include "keepout/adapters/index_registry.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/testing/index_probes.h"

namespace keepout {
namespace {

class RealIndexContract : public testing::TestWithParam<std::string_view> {};

// One test a mesh, not one an index and mesh: the brute force is most of the work.
TEST_P(RealIndexContract, EveryIndexFindsWhatBruteForceFinds) {
  const std::shared_ptr<const Mesh> mesh = load_mesh(fixture_path(GetParam())).mesh;
  // About the same number of triangles is looked at for each mesh.
  const std::size_t points = std::clamp<std::size_t>(1'000'000 / mesh->triangle_count(), 3, 40);
  const std::vector<Probe> asked = probes(*mesh, points);
  for (const IndexBackend& backend : index_backends()) {
    if (backend.name == "brute_force") continue;  // is what the others are held to
    SCOPED_TRACE(backend.name);
    expect_brute_force_sets(*mesh, *backend.make(mesh), asked);
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, RealIndexContract, testing::ValuesIn(real_meshes()), by_name);

}  // namespace
}  // namespace keepout
