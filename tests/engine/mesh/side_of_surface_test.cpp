// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>

#include "keepout/fixtures/poses.h"
#include "keepout/index/pd_tree.h"
#include "keepout/mesh/diagnostics.h"
#include "keepout/oracle/safety_oracle.h"
#include "meshes.h"
#include "step/escape.h"
#include "trials.h"

namespace keepout {
namespace {

class Classifier {
 public:
  explicit Classifier(Surface surface)
      : mesh_(mesh_of(std::move(surface))),
        near_(mesh_, std::make_shared<PdTree>(mesh_), mesh_->triangle_count(), budget_),
        oracle_(mesh_) {}

  const Mesh& mesh() const { return *mesh_; }
  bool inside(const Vec3& tip) const { return oracle_.inside(tip).value(); }
  double distance(const Vec3& tip) const { return oracle_.distance(tip); }
  std::optional<SideOfSurface> operator()(const Vec3& tip) { return find_side(near_, tip); }
  Vec3 way_out(const Vec3& tip, double longest, double off) {
    return escape_motion(near_, tip, (*this)(tip).value(), longest, off);
  }

 private:
  std::shared_ptr<const Mesh> mesh_;
  Budget budget_;
  Neighborhood near_;
  oracle::SafetyOracle oracle_;
};

Surface rotated(Surface surface, double angle) {
  const Eigen::AngleAxisd turn(angle, Vec3(0.3, -0.8, 0.5).normalized());
  for (Vec3& v : surface.vertices) v = turn * v;
  return surface;
}

/// Returns random points, and points at random distances from faces, edges and vertices.
std::vector<Vec3> tips_around(const Mesh& mesh, std::size_t count, Random& random) {
  count = test::trials(count);
  std::vector<Vec3> tips = random_points(mesh, count, random);
  const auto add = [&](const std::vector<Vec3>& points) {
    for (const Vec3& p : points) {
      tips.push_back(p + std::pow(10.0, random.uniform(-6.0, 1.0)) * random.direction());
    }
  };
  add(surface_points(mesh, count, 0.0, random));
  add(edge_points(mesh, count, random));
  add(vertex_points(mesh, count, random));
  return tips;
}

struct Solid {
  const char* shape;
  double rotation;
};

void PrintTo(const Solid& solid, std::ostream* out) { *out << solid.shape; }

class SideOfSolid : public testing::TestWithParam<Solid> {};

TEST_P(SideOfSolid, AgreesWithAnIndependentInsideTest) {
  Classifier classify(rotated(make_shape(GetParam().shape), GetParam().rotation));
  const bool inside_out = std::string_view(GetParam().shape) == "concave_sphere";
  Random random(1);
  std::size_t inside = 0, outside = 0;
  for (const Vec3& tip : tips_around(classify.mesh(), 400, random)) {
    const auto side = classify(tip);
    ASSERT_TRUE(side.has_value());
    const double distance = classify.distance(tip);
    ASSERT_NEAR(side->distance, distance, 1e-13 * (tip.norm() + 100.0));
    ASSERT_NEAR(side->outward.norm(), 1.0, 1e-12);
    if (distance < 1e-11 * (tip.norm() + 100.0)) continue;  // almost on the surface
    const bool is_inside = classify.inside(tip);
    ASSERT_EQ(!side->is_outside, is_inside != inside_out)
        << "at " << tip.transpose() << ", distance " << distance;
    ++(is_inside ? inside : outside);
  }
  EXPECT_GT(inside, test::trials(300u));
  EXPECT_GT(outside, test::trials(300u));
}

/// Found by fuzzing: one face of this tetrahedron is a sliver, whose neighbors are 6e-6 apart.
TEST(SideOfThinPart, IsKnownBeyondASliver) {
  const Vec3 beyond(-0.71015840860635471, -10.000006624243852, -9.9691710871848631);
  Classifier classify(
      {{Vec3(-9.9981689173723964, -10.0, -10.0), Vec3(6.0, -10.0, -9.9468986037994966),
        Vec3(-10.0, -10.0, -10.0), Vec3(-10.0, 4.8439765011062796, -9.9658197909514001)},
       {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}});
  Random random(1);
  std::size_t asked = 0;
  for (int i = 0; i < test::trials(3000); ++i) {
    const Vec3 tip = beyond + std::pow(10.0, random.uniform(-6.0, 1.0)) * -Vec3::UnitY() +
                     std::pow(10.0, random.uniform(-8.0, 0.0)) * random.direction();
    if (classify.distance(tip) < 1e-7) continue;  // some tolerances of a step
    ++asked;
    ASSERT_EQ(classify(tip)->is_outside, !classify.inside(tip)) << tip.transpose();
  }
  EXPECT_GT(asked, test::trials(2000u));
}

TEST_P(SideOfSolid, TheWayLeadsToTheSurfaceFromInsideAndOffItFromOutside) {
  Classifier classify(rotated(make_shape(GetParam().shape), GetParam().rotation));
  Random random(2);
  for (const Vec3& tip : tips_around(classify.mesh(), 100, random)) {
    const auto side = classify(tip);
    ASSERT_TRUE(side.has_value());
    const double distance = side->distance;
    if (distance < 1e-5) continue;
    const double towards = side->is_outside ? -1.0 : 1.0;
    const Vec3 surface = tip + towards * distance * side->outward;
    ASSERT_LE(classify.distance(surface), 1e-12 * (tip.norm() + 100.0));
  }
}

TEST_P(SideOfSolid, LeadingOutNeverLeadsDeeper) {
  Classifier classify(rotated(make_shape(GetParam().shape), GetParam().rotation));
  Random random(3);
  std::size_t forbidden = 0;
  for (const Vec3& tip : tips_around(classify.mesh(), 100, random)) {
    const auto side = classify(tip);
    ASSERT_TRUE(side.has_value());
    if (side->is_outside || side->distance < 1e-9) continue;
    ++forbidden;
    for (const double recovery : {1e-3, 0.05, 1.0, 30.0}) {
      const Vec3 way = classify.way_out(tip, recovery, 1e-4 * recovery);
      ASSERT_LE(way.norm(), recovery * (1.0 + 1e-15));
      const auto after = classify(tip + way);
      ASSERT_TRUE(after.has_value());
      if (after->is_outside) continue;
      ASSERT_LE(after->distance, side->distance * (1.0 + 1e-9) + 1e-12);
      if (way.norm() <= side->distance) {
        ASSERT_LE(after->distance, side->distance - way.norm() + 1e-9);
      }
    }
  }
  EXPECT_GT(forbidden, test::trials(50u));
}

TEST_P(SideOfSolid, DoesNotDependOnTheNumbering) {
  const Surface surface = rotated(make_shape(GetParam().shape), GetParam().rotation);
  Classifier classify(surface);
  Classifier other(shuffled(surface, 5));
  Random random(4);
  for (const Vec3& tip : tips_around(classify.mesh(), 100, random)) {
    const auto one = classify(tip);
    const auto two = other(tip);
    ASSERT_EQ(one->is_outside, two->is_outside);
    ASSERT_EQ(one->distance, two->distance);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Solids, SideOfSolid,
    testing::Values(Solid{"cube", 0.0}, Solid{"cube", 0.7}, Solid{"sphere", 0.0},
                    Solid{"concave_sphere", 0.0}, Solid{"cylinder", 0.0}, Solid{"pyramid", 0.0},
                    Solid{"pyramid", 0.7}, Solid{"gear", 0.0}, Solid{"gear", 0.7},
                    Solid{"thin_plates", 0.0}, Solid{"thin_plates", 0.7}, Solid{"star_bumps", 0.0},
                    Solid{"cortex", 0.0}),
    [](const auto& p) {
      return std::string(p.param.shape) + (p.param.rotation == 0.0 ? "" : "_rotated");
    });

/// Returns a wedge of the given opening, free outside: two faces that meet at an edge, closed by
/// distant faces. The edge is along z through the origin. [rad]
Surface wedge(double opening) {
  const double s = std::sin(0.5 * opening), c = std::cos(0.5 * opening);
  // A prism, whose base has corners at the edge and at the far ends of both faces.
  Surface out;
  for (const double z : {-10.0, 10.0}) {
    out.vertices.emplace_back(0, 0, z);
    out.vertices.emplace_back(-10 * c, 10 * s, z);
    out.vertices.emplace_back(-10 * c, -10 * s, z);
  }
  out.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                   {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  return out;
}

TEST(SideOfSurface, RightOverTheRimOfAFaceASharpEdgeDoesNotConfuse) {
  // There, the closest point of one face is on the edge. Because of rounding, that of the other
  // face may be beside it. At a sharp edge, the two normals contradict each other.
  Random random(5);
  for (int i = 0; i < 4'000; ++i) {
    const double opening = random.uniform(0.05, 2.5);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(random.uniform(0.0, 6.0), random.direction()));
    Surface surface = wedge(opening);
    for (Vec3& v : surface.vertices) v = turn * v;
    Classifier classify(surface);
    // Over the edge, along the normal of one of the two faces, with a tiny offset to each side.
    const double hand = i % 2 == 0 ? 1.0 : -1.0;
    const Vec3 normal(std::sin(0.5 * opening), hand * std::cos(0.5 * opening), 0.0);
    const Vec3 edge(0.0, 0.0, random.uniform(-8.0, 8.0));
    for (const double trifle : {0.0, 1e-16, -1e-16, 1e-15, -1e-15, 1e-13, -1e-13}) {
      const Vec3 along(-std::cos(0.5 * opening), hand * std::sin(0.5 * opening), 0.0);
      const Vec3 tip = turn * (edge + random.uniform(0.1, 2.0) * normal + trifle * along);
      const auto side = classify(tip);
      ASSERT_TRUE(side.has_value());
      ASSERT_TRUE(side->is_outside)
          << "opening " << opening << ", trifle " << trifle << ", case " << i;
    }
  }
}

TEST(SideOfSurface, ASaddleVertexIsNoTrouble) {
  // A closed cone over a star: around its apex, ridges and valleys alternate.
  Surface surface;
  constexpr int rim = 12;
  for (int i = 0; i < rim; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / rim;
    surface.vertices.emplace_back(10 * std::cos(angle), 10 * std::sin(angle),
                                  i % 2 == 0 ? 6.0 : -6.0);
  }
  surface.vertices.emplace_back(0, 0, 0);
  surface.vertices.emplace_back(0, 0, -40);
  for (VertexId i = 0; i < rim; ++i) {
    const VertexId next = (i + 1) % rim;
    surface.triangles.push_back({i, next, rim});
    surface.triangles.push_back({next, i, rim + 1});
  }
  Classifier classify(surface);
  Random random(6);
  std::size_t inside = 0;
  for (int i = 0; i < 5'000; ++i) {
    const Vec3 tip = std::pow(10.0, random.uniform(-8.0, 0.5)) * random.direction();
    const auto side = classify(tip);
    if (side->distance == 0.0) continue;  // on the surface up to rounding
    const bool is_inside = classify.inside(tip);
    ASSERT_EQ(!side->is_outside, is_inside) << tip.transpose();
    if (is_inside) ++inside;
  }
  EXPECT_GT(inside, 1'000u);
  EXPECT_LT(inside, 4'000u);
}

TEST(SideOfSurface, OnTheSurfaceTheNormalLeadsOut) {
  Classifier cube(make_cube(50));
  for (const Vec3& tip : {Vec3(3, 4, 50), Vec3(50, 0, 50), Vec3(50, 50, 50)}) {
    const auto side = cube(tip);
    ASSERT_TRUE(side.has_value());
    EXPECT_FALSE(side->is_outside);
    EXPECT_LT(side->distance, 1e-14);
    EXPECT_NEAR(side->outward.norm(), 1.0, 1e-15);
    EXPECT_FALSE(cube.inside(tip + 1e-3 * side->outward));
  }
}

TEST(SideOfSurface, FarOffIsTheSideThatIsOutsideWhicheverThatIs) {
  Surface turned = make_sphere(2.0);
  for (auto& corners : turned.triangles) std::swap(corners[0], corners[1]);
  Classifier around(make_sphere(2.0));
  Classifier within(std::move(turned));
  Random random(7);
  for (double times = 2.0; times < 1e8; times *= 3.0) {
    const Vec3 tip = times * around.mesh().bounds().size().norm() * random.direction();
    const std::optional<SideOfSurface> outside = around(tip);
    ASSERT_TRUE(outside.has_value()) << times;
    EXPECT_TRUE(outside->is_outside) << times;
    EXPECT_LE(outside->distance, around.distance(tip) * (1.0 + 1e-12)) << times;
    const std::optional<SideOfSurface> beyond = within(tip);
    ASSERT_TRUE(beyond.has_value()) << times;
    EXPECT_FALSE(beyond->is_outside) << times;
    EXPECT_NEAR(beyond->distance, within.distance(tip), 1e-12 * within.distance(tip)) << times;
    EXPECT_LT(beyond->outward.dot(tip.normalized()), -0.8) << "to the surface";
  }
}

TEST(SideOfSurface, MoreTrianglesThanThereIsRoomForHaveNoResult) {
  const auto mesh = mesh_of(make_cube(50));
  Budget budget;
  Neighborhood none(mesh, std::make_shared<PdTree>(mesh), 0, budget);
  EXPECT_FALSE(find_side(none, Vec3(0, 0, 51)).has_value());
}

TEST(LeadOut, GoesJustBeyondTheSurface) {
  Classifier cube(make_shape("cube"));  // its faces are at +-50
  EXPECT_LT((cube.way_out({3, 4, 47}, 0.5, 1e-4) - Vec3(0, 0, 0.5)).norm(), 1e-12);
  EXPECT_LT((cube.way_out({3, 4, 47}, 10.0, 1e-4) - Vec3(0, 0, 3.0001)).norm(), 1e-12);
}

TEST(LeadOut, LeavesTheSurfaceItselfToTheFreeSide) {
  for (const char* shape : {"cube", "gear", "cortex", "star_bumps"}) {
    Classifier classify(make_shape(shape));
    for (VertexId v = 0; v < classify.mesh().vertex_count(); v += 37) {  // including saddles
      const Vec3 tip = classify.mesh().vertex(v);
      const Vec3 way = classify.way_out(tip, 0.5, 1e-4);
      ASSERT_GT(way.norm(), 0.0) << shape << " vertex " << v;
      ASSERT_LE(way.norm(), 1.001e-4);
      ASSERT_FALSE(classify.inside(tip + way)) << shape << " vertex " << v;
    }
  }
}

TEST(LeadOut, DoesNotLeadIntoANeighborThatStandsCloseBy) {
  // Two boxes are 0.01 apart. The tip is 0.02 deep in the first.
  const Surface one = moved(enlarged(make_cube(1), 1.0 / 50.0), {-1, 0, 0});  // x from -2 to 0
  Classifier classify(together(one, moved(one, {2.01, 0, 0})));
  Vec3 tip(-0.02, 0.1, 0.2);
  for (int cycle = 0; cycle < 20 && classify.inside(tip); ++cycle) {
    const double depth = classify.distance(tip);
    tip += classify.way_out(tip, 0.005, 1e-4);
    ASSERT_TRUE(!classify.inside(tip) || classify.distance(tip) < depth);
  }
  EXPECT_NEAR(tip.x(), 1e-4, 1e-9);
}

TEST(SideOfSurface, ASliverAtASharpRidgeDoesNotConfuse) {
  // The ridge of the wedge has one more vertex on one side. A triangle without width closes the
  // seam.
  for (const double half_angle : {0.1, 0.3, 0.8, 1.2}) {
    const double w = std::sin(half_angle), h = std::cos(half_angle);
    Surface wedge{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.3, 0, 0), Vec3(0, -w, -h), Vec3(1, -w, -h),
                   Vec3(0, w, -h), Vec3(1, w, -h)},
                  {{0, 2, 1},  // the sliver
                   {0, 3, 2},
                   {2, 3, 4},
                   {2, 4, 1},  // one side, with the extra vertex
                   {0, 1, 5},
                   {1, 6, 5},  // the other side
                   {0, 5, 3},
                   {1, 4, 6},  // the ends
                   {3, 5, 6},
                   {3, 6, 4}}};  // the bottom
    wedge = rotated(wedge, 0.7);
    Classifier classify(wedge);
    ASSERT_TRUE(is_watertight(classify.mesh()));
    Random random(2);
    const Vec3 from = wedge.vertices[0], along = wedge.vertices[1] - from;
    for (int i = 0; i < 5000; ++i) {
      const Vec3 tip = from + random.uniform(0.02, 0.98) * along +
                       std::pow(10.0, random.uniform(-4.0, -0.5)) * random.direction();
      const auto side = classify(tip);
      ASSERT_TRUE(side.has_value());
      ASSERT_EQ(!side->is_outside, classify.inside(tip)) << half_angle << " " << i;
    }
  }
}

TEST(SideOfSurface, OverAVertexBetweenLongAndShortTrianglesIsTheSideItIsOn) {
  // At a corner of the gear, two needles meet a flat face. Rounding makes an edge appear nearer
  // than the vertex. The tips are in random directions from the vertices.
  Classifier gear(make_shape("gear"));
  Random random(6);
  std::size_t free = 0, forbidden = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 corner =
        gear.mesh().vertex(static_cast<VertexId>(random.below(gear.mesh().vertex_count())));
    const Vec3 tip = corner + std::pow(10.0, random.uniform(-3.0, 0.5)) * random.direction();
    const auto side = gear(tip);
    ASSERT_TRUE(side.has_value());
    const bool inside = gear.inside(tip);
    ASSERT_EQ(!side->is_outside, inside) << tip.transpose();
    ++(inside ? forbidden : free);
  }
  EXPECT_GT(free, 300u);
  EXPECT_GT(forbidden, 300u);
}

}  // namespace
}  // namespace keepout
