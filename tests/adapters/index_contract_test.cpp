// SPDX-License-Identifier: BSD-3-Clause
// Compares every index of the registry with brute force, by the contract that users' indices pass
// too.
#include "keepout/testing/index_contract.h"

#include "index_module.h"
#include "keepout/adapters/index_registry.h"
#include "messages.h"

namespace keepout {
namespace {

INSTANTIATE_TEST_SUITE_P(Backends, IndexContract, testing::ValuesIn(index_backends()), by_name);

TEST(IndexRegistry, AnUnknownNameListsTheKnownOnes) {
  const std::string text = error_of([] { make_index("pd-tree", mesh_of("cube")); });
  EXPECT_CONTAINS(text, "pd-tree");
  for (const IndexBackend& backend : index_backends()) EXPECT_CONTAINS(text, backend.name);
}

TEST(IndexRegistry, EveryIndexOfThisBuildIsEitherThereOrAbsent) {
  std::set<std::string_view> names;
  for (const IndexBackend& backend : index_backends()) names.insert(backend.name);
  for (const PeerPart& part : index_backends().absent()) {
    EXPECT_CONTAINS(part.needs, "install lib") << part.name;
    EXPECT_TRUE(names.insert(part.name).second) << part.name << " is both";
  }
  // And whatever else has a row.
  for (const std::string_view ours :
       {"brute_force", "wide_bvh", "pd_tree", "pd_tree_1997", "fcl_obbrss", "fcl_aabb",
        "fcl_collide", "bullet_quantized", "bullet", "bullet_callback", "embree", "cgal"}) {
    EXPECT_TRUE(names.contains(ours)) << ours;
  }
}

TEST(IndexCapacity, AMeshThatIsTooLargeIsRefusedByTheLimitAndTheWayOut) {
  EXPECT_NO_THROW(require_at_most(1000, 1000, "triangles", "bullet"));
  const std::string text = error_of([] { require_at_most(1000, 1001, "triangles", "bullet"); });
  for (const std::string_view part : {"'bullet'", "1000 triangles", "1001", "'wide_bvh'"}) {
    EXPECT_CONTAINS(text, part);
  }
}

}  // namespace
}  // namespace keepout
