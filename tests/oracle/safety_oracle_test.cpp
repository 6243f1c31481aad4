// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/safety_oracle.h"

#include <stdexcept>

#include "keepout/fixtures/poses.h"
#include "keepout/oracle/distance.h"
#include "meshes.h"
#include "trials.h"

namespace keepout::oracle {
namespace {

struct Judgement {
  bool crosses = false;
  bool below = false;
  double distance = test::infinity;
};

/// Judges by a plain loop over all triangles, exactly if the bracket contains 0 or the threshold.
Judgement plain_judgement(const Mesh& mesh, const Segment& segment, double threshold) {
  Judgement judgement;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Bracket bracket = bracket_distance(segment, mesh.triangle(t));
    double distance = bracket.estimate;
    bool below = bracket.high < threshold;
    if (!bracket.narrow() || bracket.low <= 0.0 || (!below && bracket.low < threshold)) {
      const ExactDistance exact = exact_distance(segment, mesh.triangle(t), threshold);
      judgement.crosses = judgement.crosses || exact.against_zero == 0;
      below = exact.against_threshold < 0;
      distance = exact.distance;
    }
    judgement.below = judgement.below || below;
    judgement.distance = std::min(judgement.distance, distance);
  }
  return judgement;
}

class WaysPastEveryShape : public testing::TestWithParam<Shape> {};

TEST_P(WaysPastEveryShape, IsJudgedAsByAPlainLoopOverAllTriangles) {
  const auto mesh = mesh_of(GetParam().make());
  SafetyOracle oracle(mesh);
  Random random(20261120);
  const double size = mesh->bounds().size().norm();
  std::vector<Vec3> starts = random_points(*mesh, test::trials(4u), random);
  for (const Vec3& p : vertex_points(*mesh, test::trials(2u), random)) starts.push_back(p);
  for (const Vec3& p : edge_points(*mesh, test::trials(2u), random)) starts.push_back(p);
  for (const Vec3& start : starts) {
    Vec3 tip = start;
    for (int i = 0; i < 8; ++i) {  // small and large steps, each from the end of the last one
      const double length = size * std::pow(10.0, random.uniform(-5.0, -0.5));
      const Vec3 next = i == 3 ? tip : Vec3(tip + length * random.direction());
      double threshold = i == 4 ? 0.0 : random.uniform(0.0, 2.0) * length;
      const double reach = random.uniform(0.0, 0.2) * size;
      const Judgement far = plain_judgement(*mesh, {tip, next}, threshold);
      if (i == 5) threshold = far.distance;
      const Judgement expected = i == 5 ? plain_judgement(*mesh, {tip, next}, threshold) : far;
      const Finding found = oracle.check(tip, next, threshold, reach);
      ASSERT_EQ(found.crosses, expected.crosses);
      ASSERT_EQ(found.below, expected.below);
      if (expected.distance < 0.99 * std::max(reach, threshold)) {
        ASSERT_NEAR(found.distance, expected.distance, 1e-15 * expected.distance);
        ASSERT_NE(found.triangle, no_triangle);
      } else if (expected.distance > 1.01 * std::max(reach, threshold)) {
        ASSERT_EQ(found.distance, test::infinity);
        ASSERT_EQ(found.triangle, no_triangle);
      }
      tip = next;
    }
  }
}

TEST_P(WaysPastEveryShape, IsJudgedAlikeWhateverWasAskedBefore) {
  const auto mesh = mesh_of(GetParam().make());
  const SafetyOracle fresh(mesh);
  SafetyOracle used = fresh;
  Random random(7);
  Vec3 tip = mesh->vertex(0) + 0.3 * random.direction();
  for (int i = 0; i < 300; ++i) {
    const Vec3 next = tip + random.uniform(0.0, 0.5) * random.direction();
    SafetyOracle another = fresh;
    const Finding expected = another.check(tip, next, 0.2, 0.4);
    const Finding found = used.check(tip, next, 0.2, 0.4);
    ASSERT_EQ(found.crosses, expected.crosses);
    ASSERT_EQ(found.below, expected.below);
    ASSERT_EQ(found.distance, expected.distance);
    ASSERT_EQ(found.triangle, expected.triangle);
    tip = next;
  }
}

INSTANTIATE_TEST_SUITE_P(SafetyOracle, WaysPastEveryShape, testing::ValuesIn(shapes()), by_name);

/// Returns an oracle of two adjacent squares in the plane z = 0, each of two triangles.
SafetyOracle flat_oracle(const Vec3& offset = Vec3::Zero()) {
  const Surface surface{{{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {0, 2, 0}, {2, 2, 0}, {4, 2, 0}},
                        {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}}};
  return SafetyOracle(mesh_of(moved(surface, offset)));
}

TEST(SafetyOracle, SeesACrossingThroughAFaceAnEdgeAndAVertexAlike) {
  for (const Vec3& offset : {Vec3(0, 0, 0), Vec3(1e6, -1e6, 1e6)}) {
    SafetyOracle oracle = flat_oracle(offset);
    for (const Vec3& place : {Vec3(1, 0.5, 0), Vec3(2, 1, 0), Vec3(1, 1, 0), Vec3(2, 2, 0),
                              Vec3(0, 0, 0), Vec3(4, 1, 0), Vec3(2, 0, 0)}) {
      for (const Vec3& way : {Vec3(0, 0, 1), Vec3(0.25, 0.5, 2), Vec3(-1, 0.5, -0.125)}) {
        const Vec3 p = place + offset;
        EXPECT_TRUE(oracle.check(p - way, p + way, 0.0).crosses);
        EXPECT_TRUE(oracle.check(p - way, p, 0.0).crosses) << "ends there";
        EXPECT_TRUE(oracle.check(p, p + way, 0.0).crosses) << "starts there";
        EXPECT_TRUE(oracle.check(p, p, 0.0).crosses) << "stays there";
        EXPECT_EQ(oracle.check(p - way, p + way, 0.5).distance, 0.0);
        EXPECT_TRUE(oracle.check(p - way, p + way, 0.5).below);
        EXPECT_FALSE(oracle.check(p - way, p + way, 0.0).below) << "nothing is nearer than 0";
      }
    }
  }
}

TEST(SafetyOracle, SeesAWayInThePlaneOfTheSurface) {
  SafetyOracle oracle = flat_oracle();
  EXPECT_TRUE(oracle.check({-1, 1, 0}, {5, 1, 0}, 0.0).crosses);
  EXPECT_TRUE(oracle.check({1, 0.5, 0}, {1.5, 0.5, 0}, 0.0).crosses);
  EXPECT_TRUE(oracle.check({-1, 0, 0}, {5, 0, 0}, 0.0).crosses) << "along the border";
  EXPECT_TRUE(oracle.check({-1, 1, 0}, {1, -1, 0}, 0.0).crosses) << "through a corner only";
  EXPECT_FALSE(oracle.check({-1, -1e-300, 0}, {5, -1e-300, 0}, 0.0).crosses);
  EXPECT_FALSE(oracle.check({-1, 1, 1e-300}, {5, 1, 1e-300}, 0.0).crosses);
}

TEST(SafetyOracle, TellsTheSmallestDoubleAboveTheSurfaceFromATouch) {
  SafetyOracle oracle = flat_oracle();
  const double tiny = std::numeric_limits<double>::denorm_min();
  const Finding touch = oracle.check({1, 1, 1}, {1, 1, 0}, 0.0);
  const Finding miss = oracle.check({1, 1, 1}, {1, 1, tiny}, 0.0);
  EXPECT_TRUE(touch.crosses);
  EXPECT_FALSE(miss.crosses);
  EXPECT_TRUE(oracle.check({1, 1, 1}, {1, 1, -tiny}, 0.0).crosses);
}

TEST(SafetyOracle, ComparesWithTheThresholdToTheLastPlace) {
  SafetyOracle oracle = flat_oracle();
  const double h = 0.2;
  EXPECT_FALSE(oracle.check({1, 1, h}, {1.5, 1, h}, h).below);
  EXPECT_TRUE(oracle.check({1, 1, h}, {1.5, 1, std::nextafter(h, 0.0)}, h).below);
  EXPECT_FALSE(oracle.check({1, 1, h}, {1.5, 1, std::nextafter(h, 1.0)}, h).below);
  EXPECT_EQ(oracle.check({1, 1, h}, {1.5, 1, h}, h).distance, h);
}

TEST(SafetyOracle, NeverLosesSightOfTheSurfaceOnAWayFromFreeSpaceToIt) {
  const auto mesh = mesh_of("sphere");
  SafetyOracle oracle(mesh);
  Random random(8);
  for (int way = 0; way < 20; ++way) {
    const Vec3 direction = random.direction();
    double height = 200.0;
    bool crossed = false;
    while (height > 30.0) {
      const double next = height - random.uniform(0.01, 1.0);
      const Finding finding = oracle.check(height * direction, next * direction, 0.0);
      EXPECT_FALSE(finding.crosses && next > 50.0);
      crossed = crossed || finding.crosses;
      height = next;
    }
    EXPECT_TRUE(crossed);
  }
}

TEST(SafetyOracle, DistanceOfAPointIsTheAnalyticOne) {
  const SafetyOracle oracle(mesh_of("cube"));
  EXPECT_DOUBLE_EQ(oracle.distance({0, 0, 53}), 3.0);
  EXPECT_DOUBLE_EQ(oracle.distance({1, 2, 3}), 47.0);
  EXPECT_DOUBLE_EQ(oracle.distance({53, 54, 0}), 5.0);
  EXPECT_DOUBLE_EQ(oracle.distance({52, 53, 56}), 7.0);
  EXPECT_EQ(oracle.distance({50, 1, 2}), 0.0);
  EXPECT_EQ(oracle.distance({-50, 50, -50}), 0.0);
}

TEST(SafetyOracle, RefusesWhatIsNotANumber) {
  SafetyOracle oracle = flat_oracle();
  EXPECT_THROW(oracle.check({test::nan, 0, 0}, {0, 0, 0}, 0.1), std::invalid_argument);
  EXPECT_THROW(oracle.check({0, 0, 0}, {0, test::infinity, 0}, 0.1), std::invalid_argument);
  EXPECT_THROW(oracle.check({0, 0, 0}, {0, 0, 0}, -0.1), std::invalid_argument);
  EXPECT_THROW(oracle.check({0, 0, 0}, {0, 0, 0}, test::nan), std::invalid_argument);
}

}  // namespace
}  // namespace keepout::oracle
