// SPDX-License-Identifier: BSD-3-Clause
// Every narrow phase returns an answer or a reason for any input. `keepout compare` measures the
// accuracy of the libraries: docs/convex_tools.md.

#include <cmath>
#include <set>

#include "engine/geometry/tools.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "trials.h"

namespace keepout {
namespace {

class NarrowPhaseContract : public testing::TestWithParam<NarrowPhaseBackend> {};

Triangle triangle_at(const Vec3& place, double size, Random& random) {
  Triangle t;
  for (Vec3& corner : t) corner = place + size * random.direction();
  return t;
}

void expect_sane(const NarrowPhaseAnswer& answer) {
  if (!answer.answered()) return;
  EXPECT_TRUE(std::isfinite(answer.separation.distance));
  EXPECT_TRUE(answer.separation.on_triangle.allFinite());
  EXPECT_NEAR(answer.separation.normal.norm(), 1.0, 1e-8);
}

TEST_P(NarrowPhaseContract, TellsApartFromOverlappingWellOffATouch) {
  Random random(1);
  std::size_t pairs = 0, failed = 0, wrong = 0, far_off = 0;
  for (int i = 0; i < 300; ++i) {
    for (const test::NamedTool& named : test::tools_of_each_kind(3.0, random)) {
      const auto narrow_phase = GetParam().make(named.tool);
      const Vec3 position = 100.0 * random.direction();
      const Triangle triangle =
          triangle_at(position + random.uniform(0.0, 4.0) * random.direction(), 1.0, random);
      const Separation exact = separation(named.tool, position, triangle);
      if (std::abs(exact.distance) < 0.1) continue;
      const NarrowPhaseAnswer answer = narrow_phase->separation(position, triangle);
      expect_sane(answer);
      ++pairs;
      failed += !answer.answered();
      if (!answer.answered()) continue;
      wrong += (answer.separation.distance > 0.0) != (exact.distance > 0.0);
      far_off += std::abs(answer.separation.distance - exact.distance) > 1e-6;
    }
  }
  EXPECT_GT(pairs, 500u);
  EXPECT_LE(failed, pairs / 50);
  EXPECT_LE(wrong, pairs / 10);
  if (GetParam().name == "exact") {
    EXPECT_EQ(failed + wrong + far_off, 0u);
  }
}

TEST_P(NarrowPhaseContract, ComesBackFromTouchesAndDegenerateTriangles) {
  Random random(2);
  for (int i = 0; i < 150; ++i) {
    for (const test::NamedTool& named : test::tools_of_each_kind(3.0, random)) {
      const auto narrow_phase = GetParam().make(named.tool);
      Triangle triangle = triangle_at(Vec3::Zero(), 1.0, random);
      if (i % 5 == 1) triangle[2] = triangle[1];
      if (i % 5 == 2) triangle[1] = triangle[2] = triangle[0];
      if (i % 5 == 3) triangle[2] = 0.5 * (triangle[0] + triangle[1]);
      const Vec3 off = 4.0 * random.direction();
      const Separation start = separation(named.tool, off, triangle);
      const double tiny = std::pow(10.0, random.uniform(-18.0, -6.0)) * (i % 2 == 0 ? 1.0 : -1.0);
      expect_sane(narrow_phase->separation(off - (start.distance + tiny) * start.normal, triangle));
    }
  }
}

TEST_P(NarrowPhaseContract, ComesBackFromWhatLiesOnALattice) {
  Random random(3);
  const ConvexTool box = ConvexTool::box({Vec3(-1, -1, -1), Vec3(1, 1, 1)});
  const auto narrow_phase = GetParam().make(box);
  for (int i = 0; i < 1000; ++i) {
    Triangle triangle;
    for (Vec3& corner : triangle) {
      for (int axis = 0; axis < 3; ++axis) {
        corner[axis] = static_cast<double>(random.below(7)) * 0.5 - 1.5;
      }
    }
    expect_sane(narrow_phase->separation(Vec3::Zero(), triangle));
  }
}

TEST_P(NarrowPhaseContract, ComesBackFromNumbersOutOfRange) {
  const double huge = std::numeric_limits<double>::max();
  Random random(4);
  for (const double number : {std::nan(""), test::infinity, -test::infinity, huge, 1e200, 1e-300}) {
    for (const test::NamedTool& named : test::tools_of_each_kind(3.0, random)) {
      const auto narrow_phase = GetParam().make(named.tool);
      Triangle triangle = triangle_at({3, 0, 0}, 1.0, random);
      triangle[1].y() = number;
      const NarrowPhaseAnswer answer = narrow_phase->separation(Vec3::Zero(), triangle);
      if (std::isfinite(number) && GetParam().name != "exact") expect_sane(answer);
      narrow_phase->separation(Vec3(number, 0, 0), triangle);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, NarrowPhaseContract,
                         testing::ValuesIn(narrow_phase_backends().begin(),
                                           narrow_phase_backends().end()),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(NarrowPhaseRegistry, NamesWhatThereIsAndWhatIsMissing) {
  EXPECT_EQ(narrow_phase_backends().front().name, "exact");
  std::set<std::string_view> names;
  for (const NarrowPhaseBackend& backend : narrow_phase_backends()) {
    names.insert(backend.name);
    EXPECT_EQ(backend.allocation == Allocation::never, backend.name == "exact") << backend.name;
  }
  for (const PeerPart& part : narrow_phase_backends().absent()) {
    EXPECT_TRUE(names.insert(part.name).second) << part.name << " is both";
  }
  // All known narrow phases are either present or absent.
  for (const std::string_view ours :
       {"exact", "ccd_gjk", "ccd_mpr", "fcl_gjk_libccd", "fcl_gjk_indep"}) {
    EXPECT_TRUE(names.contains(ours)) << ours;
  }
  const ConvexTool tool = ConvexTool::sphere(1.0);
  try {
    make_narrow_phase("none", tool);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("exact"), std::string::npos);
  }
  for (const PeerPart& part : narrow_phase_backends().absent()) {
    EXPECT_THROW(make_narrow_phase(part.name, tool), Error);
  }
}

}  // namespace
}  // namespace keepout
