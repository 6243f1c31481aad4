// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <csignal>

#include "compare/agreement.h"
#include "compare/compare.h"
#include "keepout/fixtures/shapes.h"
#include "meshes.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

IndexComparison on_a_cube() {
  return {.mesh_name = "cube",
          .mesh = mesh_of(make_cube(5.0)),
          .indices = {"wide_bvh", "pd_tree"},
          .activations = {"all_faces", "paper", "certified"},
          .poses = 30};
}

TEST(IndexAgreement, StepsTheFormsThatAreShipped) {
  std::size_t asked = 0;
  const auto rows = compare_indices(on_a_cube(), [&] { return ++asked == 0; });
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(asked, 3u * 3 * 30) << "of brute force and of each index, under each rule";
  for (const IndexAgreement& row : rows) {
    SCOPED_TRACE(row.index + " " + row.activation);
    // The one offers a walk along motions, both their triangles in blocks.
    const bool offers = row.activation == "certified"
                            ? row.index == "wide_bvh"
                            : row.activation == "paper" && row.index != "fcl_obbrss";
    EXPECT_EQ(row.searched, offers);
    EXPECT_EQ(row.poses, 30u);
    EXPECT_EQ(row.missed + row.invented + row.steps_that_differ, 0u);
    EXPECT_LT(row.closest_point_error, 1e-12);
  }
}

TEST(IndexAgreement, KeepsTheRowsThatWereFinishedWhenItIsStopped) {
  std::size_t asked = 0;
  const auto rows = compare_indices(on_a_cube(), [&] { return ++asked > 30 * 3 + 30 + 7; });
  ASSERT_EQ(rows.size(), 1u) << "brute force, and the first index under the first rule";
  EXPECT_EQ(rows.front().index, "wide_bvh");
  EXPECT_EQ(rows.front().poses, 30u);
}

TEST(Compare, EndsAtOnceWhenTheSignalHasCome) {
  std::signal(SIGINT, SIG_DFL);  // which is ignored where tests run in the background
  const StopSignal stop;
  ASSERT_EQ(std::raise(SIGINT), 0);
  const IndexComparison on = on_a_cube();
  const Comparison comparison =
      compare_parts(on.mesh_name, on.mesh, {}, [&stop] { return stop.has_come(); });
  EXPECT_FALSE(comparison.complete);
  EXPECT_TRUE(comparison.indices.empty() && comparison.solvers.empty() &&
              comparison.narrow_phases.empty());
}

}  // namespace
}  // namespace keepout::app
