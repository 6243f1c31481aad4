// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <set>

#include "compare/agreement.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "keepout/fixtures/shapes.h"

namespace keepout::app {
namespace {

TEST(NarrowPhaseAgreement, EveryNarrowPhaseIsHeldToTheSamePairs) {
  const Mesh mesh(make_sphere(3.0));
  const auto rows = compare_narrow_phases(mesh, 40, 1);
  ASSERT_EQ(rows.size(), 4 * 3 * narrow_phase_backends().size());
  std::set<std::string> backends, tools, relations;
  for (const NarrowPhaseAgreement& row : rows) {
    SCOPED_TRACE(row.backend + " " + row.tool + " " + row.relation);
    backends.insert(row.backend);
    tools.insert(row.tool);
    relations.insert(row.relation);
    EXPECT_EQ(row.pairs, 40u);
    EXPECT_LE(row.failed + row.contradicted, row.pairs);
    EXPECT_LE(row.median_error, row.worst_error);
    EXPECT_GT(row.median_us, 0.0);
    EXPECT_LE(row.median_us, row.p99_us);
    if (row.backend != "exact") continue;
    EXPECT_EQ(row.failed + row.contradicted, 0u);
    EXPECT_EQ(row.worst_error, 0.0);
    EXPECT_LT(row.worst_unproven, 1e-13);
  }
  EXPECT_EQ(backends.size(), narrow_phase_backends().size());
  EXPECT_EQ(tools, (std::set<std::string>{"sphere", "capsule", "box", "hull"}));
  EXPECT_EQ(relations, (std::set<std::string>{"apart", "touching", "overlapping"}));
}

}  // namespace
}  // namespace keepout::app
