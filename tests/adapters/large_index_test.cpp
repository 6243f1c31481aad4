// SPDX-License-Identifier: BSD-3-Clause
// More triangles than 21 bits can number. Bullet alone would confuse some of them without an error.

#include "keepout/adapters/index_registry.h"
#include "keepout/testing/index_probes.h"

namespace keepout {
namespace {

constexpr std::size_t number_of_21_bits = std::size_t{1} << 21;

class LargeIndex : public testing::TestWithParam<IndexBackend> {};

TEST_P(LargeIndex, LosesNothingOfMoreThan2To21Triangles) {
  if (GetParam().name == "brute_force") return;  // is the reference
  const auto mesh = mesh_of(make_cube(0.236));
  ASSERT_GT(mesh->triangle_count(), number_of_21_bits + 10'000);
  const auto index = GetParam().make(mesh);

  TriangleBuffer candidates(mesh->triangle_count());
  index->collect({Vec3::Zero(), 1e3}, candidates);
  ASSERT_FALSE(candidates.overflowed());
  ASSERT_EQ(candidates.size(), mesh->triangle_count());
  std::sort(candidates.begin(), candidates.end());
  for (TriangleId t = 0; t < candidates.size(); ++t) ASSERT_EQ(candidates[t], t);

  // Each triangle is found at its position, in particular those near the limit.
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    const auto t = static_cast<TriangleId>(i < 1000 ? random.below(mesh->triangle_count())
                                                    : number_of_21_bits - 500 +
                                                          static_cast<std::size_t>(i - 1000));
    const Triangle corners = mesh->triangle(t);
    candidates.clear();
    index->collect({(corners[0] + corners[1] + corners[2]) / 3.0, 1e-3}, candidates);
    ASSERT_NE(std::find(candidates.begin(), candidates.end(), t), candidates.end()) << t;
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, LargeIndex, testing::ValuesIn(index_backends()), by_name);

}  // namespace
}  // namespace keepout
