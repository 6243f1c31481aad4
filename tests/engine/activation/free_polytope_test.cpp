// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/free_polytope.h"

#include <Eigen/Dense>
#include <numeric>

#include "activation/polytope/free_polytope_triangle.h"
#include "keepout/error.h"
#include "keepout/fixtures/counterexamples.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/brute_force.h"
#include "meshes.h"
#include "trials.h"

namespace keepout {
namespace {

/// A query for a free polytope. All [length].
struct Question {
  Vec3 tip;
  double radius;
  double margin;
};

std::vector<Hit> hits_of(const std::shared_ptr<const Mesh>& mesh, const Question& question) {
  TriangleBuffer candidates(mesh->triangle_count());
  HitBuffer hits(mesh->triangle_count());
  const Ball ball{question.tip, question.radius + question.margin};
  BruteForce(mesh).collect(ball, candidates);
  refine(*mesh, ball, candidates.view(), hits);
  return {hits.begin(), hits.end()};
}

struct Answer {
  Status status;
  std::vector<HalfSpace> planes;
  std::vector<Hit> hits;
};

Answer polytope(const std::shared_ptr<const Mesh>& mesh, const Question& q,
                std::size_t planes_capacity = 4096) {
  FreePolytope free(mesh, mesh->triangle_count());
  HalfSpaceBuffer planes(planes_capacity);
  std::vector<Hit> hits = hits_of(mesh, q);
  Budget unlimited;
  const Status status = free.around(q.tip, q.radius, q.margin, hits, unlimited, planes);
  return {status, {planes.begin(), planes.end()}, std::move(hits)};
}

/// Returns a closest-point plane for each hit, for the same clearance, as a caller without a
/// polytope would.
std::vector<HalfSpace> naive_planes(const std::vector<Hit>& hits, double margin) {
  double kept = margin;
  for (const Hit& hit : hits) kept = std::min(kept, hit.closest.distance);
  std::vector<HalfSpace> planes;
  for (const Hit& hit : hits) {
    const double distance = hit.closest.distance;
    planes.push_back({-hit.closest.offset / distance, kept - distance, hit.triangle});
  }
  return planes;
}

bool is_within(const std::vector<HalfSpace>& planes, const Vec3& d) {
  return std::all_of(planes.begin(), planes.end(),
                     [&](const HalfSpace& p) { return p.normal.dot(d) >= p.offset; });
}

/// Returns the fraction of the ball that the planes leave free.
double share_of_ball(const std::vector<HalfSpace>& planes, double radius, Random& random) {
  constexpr int samples = 1000;
  int within = 0;
  for (int i = 0; i < samples; ++i) {
    const Vec3 direction = random.direction();
    within += is_within(planes, radius * std::cbrt(random.uniform()) * direction) ? 1 : 0;
  }
  return static_cast<double>(within) / samples;
}

double nearest_of(const Mesh& mesh, const std::vector<Hit>& hits, const Vec3& point) {
  double nearest = test::infinity;
  for (const Hit& hit : hits) {
    nearest = std::min(nearest, closest_point(mesh.triangle(hit.triangle), point).distance);
  }
  return nearest;
}

/// Searches for motions within planes and ball that come too close. Tries random motions, the
/// boundary, the corners of the polytope, and the motions nearest to the triangles' corners.
class Attack {
 public:
  Attack(const Mesh& mesh, const Question& question, const Answer& answer)
      : mesh_(mesh), question_(question), answer_(answer) {
    double nearest = question.margin;
    double size = 0.0;
    for (const Hit& hit : answer.hits) {
      nearest = std::min(nearest, hit.closest.distance);
      for (const Vec3& corner : mesh.triangle(hit.triangle)) {
        size = std::max(size, (corner - question.tip).norm());
      }
    }
    // The promised clearance, less the rounding of tip + d, here as in the caller's code.
    allowed_ = nearest - 1e-12 * question.radius - 2e-14 * size - 4e-16 * question.tip.lpNorm<1>() -
               4e-16 * question.radius;
  }

  /// Returns the number of tried motions that come too close.
  int run(Random& random) {
    for (int i = 0; i < 40; ++i) {
      const Vec3 out = outermost(random.direction());
      attempt(out);
      attempt(random.uniform() * out);
    }
    for (const Hit& hit : some(answer_.hits, 60)) {
      attempt(toward(hit.closest.offset));
      for (const Vec3& corner : mesh_.triangle(hit.triangle)) {
        attempt(outermost(corner - question_.tip));
        attempt(toward(corner - question_.tip));
      }
    }
    corners();
    return violations_;
  }

 private:
  template <class T>
  static std::vector<T> some(const std::vector<T>& all, std::size_t most) {
    std::vector<T> few;
    const std::size_t stride = std::max<std::size_t>(1, all.size() / most);
    for (std::size_t i = 0; i < all.size(); i += stride) few.push_back(all[i]);
    return few;
  }

  /// Returns the farthest allowed motion along d. Planes and ball contain 0 and are convex.
  Vec3 outermost(const Vec3& d) const { return reduced(d * (question_.radius / d.norm())); }

  Vec3 reduced(const Vec3& d) const {
    double share = std::min(1.0, question_.radius / d.norm());
    for (const HalfSpace& p : answer_.planes) {
      const double along = p.normal.dot(d);
      if (along * share < p.offset) share = std::max(0.0, p.offset / along);
    }
    return share * d;
  }

  /// Returns almost the nearest allowed motion to a point, by Dykstra's alternating projections.
  Vec3 toward(const Vec3& point) const {
    const auto& planes = answer_.planes;
    std::vector<Vec3> corrections(planes.size() + 1, Vec3::Zero());
    Vec3 d = point;
    for (int round = 0; round < 15; ++round) {
      for (std::size_t i = 0; i <= planes.size(); ++i) {
        const Vec3 before = d + corrections[i];
        d = before;
        if (i == planes.size()) {
          if (d.norm() > question_.radius) d *= question_.radius / d.norm();
        } else {
          const double short_by = planes[i].offset - planes[i].normal.dot(d);
          if (short_by > 0.0) d += short_by * planes[i].normal;
        }
        corrections[i] = before - d;
      }
    }
    return d.norm() > 0.0 ? reduced(d) : d;
  }

  /// Tries the points where three planes meet, or two planes and the sphere.
  void corners() {
    const std::vector<HalfSpace> planes = some(answer_.planes, 10);
    for (std::size_t i = 0; i < planes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        Eigen::Matrix3d rows;
        rows << planes[i].normal.transpose(), planes[j].normal.transpose(),
            planes[i].normal.cross(planes[j].normal).transpose();
        if (rows.row(2).norm() < 1e-6) continue;
        const Vec3 foot = rows.inverse() * Vec3(planes[i].offset, planes[j].offset, 0.0);
        const double rest = question_.radius * question_.radius - foot.squaredNorm();
        if (rest > 0.0) {
          const Vec3 way = std::sqrt(rest) * rows.row(2).transpose().normalized();
          for (const Vec3& d : {Vec3(foot + way), Vec3(foot - way)}) attempt(reduced(d));
        }
        for (std::size_t k = 0; k < j; ++k) {
          rows.row(2) = planes[k].normal.transpose();
          if (std::abs(rows.determinant()) < 1e-6) continue;
          const Vec3 d =
              rows.inverse() * Vec3(planes[i].offset, planes[j].offset, planes[k].offset);
          if (d.norm() > 0.0) attempt(reduced(d));
        }
      }
    }
  }

  void attempt(const Vec3& d) {
    if (d.norm() > question_.radius * (1.0 + 1e-15)) return;
    if (nearest_of(mesh_, answer_.hits, question_.tip + d) < allowed_) ++violations_;
  }

  const Mesh& mesh_;
  Question question_;
  const Answer& answer_;
  double allowed_ = 0.0;
  int violations_ = 0;
};

/// Returns tips at all kinds of places near a mesh, on both sides.
std::vector<Vec3> tips_near(const Mesh& mesh, std::size_t count, Random& random) {
  std::vector<Vec3> tips;
  for (const double offset : {0.5, -0.5, 0.01}) {
    for (const Vec3& p : surface_points(mesh, count, offset, random)) tips.push_back(p);
  }
  for (const double offset : {0.3, 1e-3, 1e-6}) {
    for (const Vec3& p : vertex_points(mesh, count, random)) {
      tips.push_back(p + offset * random.direction());
    }
    for (const Vec3& p : edge_points(mesh, count, random)) {
      tips.push_back(p + offset * random.direction());
    }
  }
  return tips;
}

TEST(FreePolytope, EveryMotionWithinItKeepsItsDistance) {
  std::size_t found = 0, asked = 0;
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    const auto mesh = mesh_of(shape.make());
    Random random(1);
    for (const Vec3& tip : tips_near(*mesh, test::trials(4u), random)) {
      for (const auto& [radius, margin] : {std::pair{3.0, 0.25}, {1.0, 0.0}, {2.0, 1.5}}) {
        const Question question{tip, radius, margin};
        const Answer answer = polytope(mesh, question);
        ++asked;
        if (answer.status == Status::touching) continue;
        ASSERT_EQ(answer.status, Status::free);
        ++found;
        for (const HalfSpace& plane : answer.planes) {
          ASSERT_LE(plane.offset, 0.0);
          ASSERT_NEAR(plane.normal.norm(), 1.0, 1e-14);
        }
        EXPECT_EQ(Attack(*mesh, question, answer).run(random), 0)
            << "tip " << tip.transpose() << ", radius " << radius << ", margin " << margin;
      }
    }
  }
  EXPECT_GT(found, asked * 95 / 100);
}

TEST(FreePolytope, CounterexamplesToThePapersRuleAreKeptClear) {
  Random random(2);
  for (const Counterexample& example : counterexamples()) {
    SCOPED_TRACE(example.name);
    const auto mesh = mesh_of(example.surface);
    for (const double margin : {0.0, 0.01, 0.5}) {
      const Question question{example.tip, example.radius, margin};
      const Answer answer = polytope(mesh, question);
      if (example.name == "CE4_on_a_ridge") {
        EXPECT_EQ(answer.status, Status::touching);
        continue;
      }
      ASSERT_EQ(answer.status, Status::free);
      EXPECT_EQ(Attack(*mesh, question, answer).run(random), 0);
    }
  }
}

TEST(FreePolytope, CrowdsOfTrianglesOfAnySizeAreKeptClear) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    Surface surface;
    for (VertexId t = 0; t < 12; ++t) {
      const double size = std::pow(10.0, random.uniform(-3.0, 3.0));
      const Vec3 place = random.uniform(0.05, 2.5) * random.direction();
      for (int i = 0; i < 3; ++i) {
        surface.vertices.push_back(place + size * random.uniform() * random.direction());
      }
      surface.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const auto mesh = mesh_of(surface);
    const Question question{Vec3::Zero(), 1.0, random.uniform(0.0, 0.1)};
    const Answer answer = polytope(mesh, question);
    ASSERT_EQ(answer.status, Status::free);
    EXPECT_EQ(Attack(*mesh, question, answer).run(random), 0) << "round " << round;
  }
}

TEST(FreePolytope, InAThinGapItIsTheGap) {
  const auto mesh = mesh_of("thin_plates");
  const Question question{{0.2, 0.1, mesh->bounds().low.z() + 1.4}, 2.0, 0.1};
  const Answer answer = polytope(mesh, question);
  ASSERT_EQ(answer.planes.size(), 2u);
  for (const HalfSpace& plane : answer.planes) {
    EXPECT_NEAR(std::abs(plane.normal.z()), 1.0, 1e-12);
    const double room = plane.normal.z() > 0.0 ? 0.3 : 0.5;
    EXPECT_NEAR(plane.offset, -room, 0.021);
    EXPECT_GE(plane.offset, -room);
  }
}

TEST(FreePolytope, BothSidesOfAPlateAreSolid) {
  const auto mesh = mesh_of(single_triangle());
  for (const double side : {1.0, -1.0}) {
    const Answer answer = polytope(mesh, {{0.2, 0.2, 0.1 * side}, 1.0, 0.01});
    ASSERT_EQ(answer.planes.size(), 1u);
    EXPECT_NEAR(answer.planes[0].normal.z(), side, 1e-15);
  }
}

TEST(FreePolytope, CloserThanTheMarginThePlateCanStillBeFollowed) {
  const auto mesh = mesh_of("flat_plate");
  const Answer answer = polytope(mesh, {{1, 2, 0.2}, 3.0, 0.5});
  ASSERT_EQ(answer.planes.size(), 1u);
  EXPECT_EQ(answer.planes[0].offset, 0.0);
  EXPECT_TRUE(is_within(answer.planes, {2.0, -2.0, 0.0}));
}

TEST(FreePolytope, WhatTheBallCannotReachOfATriangleDoesNotCount) {
  // A ramp rises out of the plate, beyond the ball.
  const Surface surface{{{-50, -50, 0}, {50, -50, 0}, {0, 50, 0}, {-50, 0, 30}, {-50, 1, 30}},
                        {{0, 1, 2}, {1, 3, 4}}};
  const auto mesh = mesh_of(surface);
  const Answer answer = polytope(mesh, {{40, -48, 1.0}, 1.5, 0.1});
  ASSERT_EQ(answer.planes.size(), 1u);
  EXPECT_NEAR(answer.planes[0].offset, -0.9, 0.02);
}

TEST(FreePolytope, VeryNearToAnEdgeThereIsStillASide) {
  Random random(4);
  for (const double distance : {1e-3, 1e-6, 1e-9, 1e-11}) {
    for (int i = 0; i < 500; ++i) {
      const Vec3 a = 3.0 * random.direction();
      const Vec3 b = 3.0 * random.direction();
      const Vec3 c = 3.0 * random.direction();
      const Vec3 edge = (b - a).normalized();
      const Vec3 outwards = ((a - c) - edge * edge.dot(a - c)).normalized();
      const double angle = random.uniform(-1.5, 1.5);
      const Vec3 away = std::cos(angle) * outwards + std::sin(angle) * edge.cross(outwards);
      const auto mesh = mesh_of(Surface{{a, b, c}, {{0, 1, 2}}});
      const Question question{a + random.uniform() * (b - a) + distance * away, 1.0, 0.25};
      const Answer answer = polytope(mesh, question);
      ASSERT_EQ(answer.status, Status::free) << distance << " at " << angle;
      EXPECT_EQ(Attack(*mesh, question, answer).run(random), 0);
    }
  }
}

TEST(FreePolytope, OnTheMeshNoSideIsGuessed) {
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    const auto mesh = mesh_of(shape.make());
    Random random(5);
    for (const Vec3& tip : vertex_points(*mesh, 5, random)) {
      const Answer answer = polytope(mesh, {tip, 1.0, 0.25});
      EXPECT_EQ(answer.status, Status::touching);
      EXPECT_TRUE(is_within(answer.planes, Vec3::Zero()));
      for (int i = 0; i < 10; ++i) {
        const Vec3 any = 1e-9 * random.direction();
        EXPECT_FALSE(is_within(answer.planes, any));
      }
    }
  }
}

/// Returns the same surface with its vertices shuffled and about half of its triangles flipped.
Surface disguised(const Surface& original, unsigned seed, std::vector<TriangleId>& new_ids) {
  Surface surface = shuffled(original, seed, &new_ids);
  std::mt19937 random(seed + 1);
  std::vector<VertexId> to(surface.vertices.size());
  std::iota(to.begin(), to.end(), VertexId{0});
  std::shuffle(to.begin(), to.end(), random);
  for (std::size_t v = 0; v < to.size(); ++v) surface.vertices[to[v]] = original.vertices[v];
  for (Corners& c : surface.triangles) {
    for (VertexId& v : c) v = to[v];
    if (random() % 2 == 0) std::swap(c[1], c[2]);
  }
  return surface;
}

void expect_same(const Answer& one, const Answer& other) {
  ASSERT_EQ(one.status, other.status);
  ASSERT_EQ(one.planes.size(), other.planes.size());
  for (std::size_t i = 0; i < one.planes.size(); ++i) {
    ASSERT_EQ(one.planes[i].normal, other.planes[i].normal);
    ASSERT_EQ(one.planes[i].offset, other.planes[i].offset);
  }
}

TEST(FreePolytope, NumberingAndWindingChangeNoBit) {
  std::size_t compared = 0;
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    const Surface surface = shape.make();
    const auto mesh = mesh_of(surface);
    Random random(6);
    const std::vector<Vec3> tips = tips_near(*mesh, 2, random);
    std::vector<TriangleId> new_ids;
    const auto other = mesh_of(disguised(surface, 7, new_ids));
    for (const Vec3& tip : tips) {
      const Answer one = polytope(mesh, {tip, 3.0, 0.25});
      expect_same(one, polytope(other, {tip, 3.0, 0.25}));
      compared += one.planes.size();
    }
  }
  EXPECT_GT(compared, test::trials(500u));
}

TEST(FreePolytope, FarFromTheOriginNothingIsLost) {
  const Surface plain = torus(24);
  Surface far = plain;
  const double offset = 0x1p40;
  for (Vec3& v : far.vertices) v = (v * 0x1p10).array().round() / 0x1p10 + offset;
  const Surface near = moved(far, Vec3::Constant(-offset));
  const Vec3 tip(3.5, 0.5, 1.25);
  const Answer there = polytope(mesh_of(far), {tip.array() + offset, 2.0, 0.0625});
  const Answer here = polytope(mesh_of(near), {tip, 2.0, 0.0625});
  ASSERT_FALSE(here.planes.empty());
  expect_same(there, here);
}

TEST(FreePolytope, ItLeavesMoreThanAPlaneForEachHitAndWithFewerPlanes) {
  double share = 0.0, naive_share = 0.0;
  double planes = 0.0, naive_count = 0.0;
  for (const Shape& shape : shapes_to_try()) {
    const auto mesh = mesh_of(shape.make());
    Random random(8);
    double of_shape = 0.0, naive_of_shape = 0.0;
    constexpr int tips = 20;
    for (const Vec3& tip : surface_points(*mesh, tips, 0.5, random)) {
      const Answer answer = polytope(mesh, {tip, 3.0, 0.25});
      ASSERT_EQ(answer.status, Status::free) << shape.name;
      const std::vector<HalfSpace> naive = naive_planes(answer.hits, 0.25);
      of_shape += share_of_ball(answer.planes, 3.0, random) / tips;
      naive_of_shape += share_of_ball(naive, 3.0, random) / tips;
      planes += static_cast<double>(answer.planes.size()) / tips;
      naive_count += static_cast<double>(naive.size()) / tips;
    }
    // If the ball meets one or two triangles only, both sets differ by the standoff alone.
    EXPECT_GT(of_shape, naive_of_shape - 0.02) << shape.name;
    share += of_shape / static_cast<double>(shapes().size());
    naive_share += naive_of_shape / static_cast<double>(shapes().size());
  }
  // Measured: 0.50 of the ball against 0.31, with an eighth of the planes.
  EXPECT_GT(share, 1.4 * naive_share);
  EXPECT_LT(planes, 0.2 * naive_count);
}

TEST(FreePolytope, WhatDoesNotFitIsAStatusAndHoldsStill) {
  const auto mesh = mesh_of("concave_sphere");
  const Question question{{0, 0, 47}, 5.0, 0.5};
  const std::size_t needed = polytope(mesh, question).planes.size();
  ASSERT_GT(needed, 7u);
  EXPECT_EQ(polytope(mesh, question, needed).status, Status::free);
  const Answer short_by_one = polytope(mesh, question, needed - 1);
  EXPECT_EQ(short_by_one.status, Status::over_capacity);
  EXPECT_TRUE(is_within(short_by_one.planes, Vec3::Zero()));
  EXPECT_FALSE(is_within(short_by_one.planes, Vec3(0, 0, -1e-9)));

  HalfSpaceBuffer planes(100);
  Budget unlimited;
  FreePolytope two_hits(mesh, 2);
  EXPECT_EQ(two_hits.around(question.tip, 5.0, 0.5, hits_of(mesh, question), unlimited, planes),
            Status::over_capacity);
  EXPECT_EQ(planes.size(), 6u);

  HalfSpaceBuffer tiny(2);
  FreePolytope free(mesh, 1000);
  EXPECT_EQ(free.around(question.tip, 5.0, 0.5, hits_of(mesh, question), unlimited, tiny),
            Status::over_capacity);
  EXPECT_TRUE(tiny.overflowed());

  Budget too_little(needed);
  EXPECT_EQ(free.around(question.tip, 5.0, 0.5, hits_of(mesh, question), too_little, planes),
            Status::out_of_budget);
  EXPECT_EQ(planes.size(), 6u);
}

TEST(FreePolytope, WhatIsNoNumberIsRefused) {
  const auto mesh = mesh_of(tetrahedron());
  FreePolytope free(mesh, 4);
  HalfSpaceBuffer planes(10);
  Budget unlimited;
  const double nan = std::nan("");
  const Vec3 tip(2, 2, 2);
  EXPECT_EQ(free.around(tip, 1.0, 0.1, {}, unlimited, planes), Status::free);
  EXPECT_TRUE(planes.empty());
  EXPECT_EQ(free.around({nan, 0, 0}, 1.0, 0.1, {}, unlimited, planes), Status::invalid_input);
  EXPECT_EQ(planes.size(), 6u);
  EXPECT_EQ(free.around(tip, -1.0, 0.1, {}, unlimited, planes), Status::invalid_input);
  EXPECT_EQ(free.around(tip, 1.0, nan, {}, unlimited, planes), Status::invalid_input);
  std::vector<Hit> hits{{4, {Vec3::UnitX(), 1.0, Feature::face}}};
  EXPECT_EQ(free.around(tip, 1.0, 0.1, hits, unlimited, planes), Status::invalid_input);
  hits[0] = {0, {Vec3::UnitX(), nan, Feature::face}};
  EXPECT_EQ(free.around(tip, 1.0, 0.1, hits, unlimited, planes), Status::invalid_input);
  EXPECT_THROW(FreePolytope(nullptr, 4), Error);
}

TEST(FreePolytope, EveryStatusHasANameAndAReason) {
  for (const Status status : {Status::free, Status::touching, Status::invalid_input,
                              Status::over_capacity, Status::unsupported, Status::mesh_changed}) {
    EXPECT_NE(name(status), "unknown");
    EXPECT_NE(reason(status, Subject::polytope), "unknown status");
  }
}

TEST(SupportWithin, IsThatOfTheSamplesOfTheTriangleInTheBall) {
  constexpr int steps = 200;
  Random random(9);
  int parts = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 at = random.uniform(0.0, 0.9) * random.direction();
    Triangle corners;
    for (Vec3& corner : corners) corner = at + random.uniform(0.1, 3.0) * random.direction();
    const Vec3 normal = random.direction();
    double most = -test::infinity;  // of samples: a grid on the triangle, and points of its sides
    double spacing = 0.0;
    const auto add = [&](const Vec3& p) {
      if (p.norm() <= 1.0) most = std::max(most, normal.dot(p));
    };
    for (int side = 0; side < 3; ++side) {
      const Vec3 first = corners[side], along = corners[(side + 1) % 3] - first;
      spacing = std::max(spacing, along.norm() / steps);
      for (int i = 0; i <= 50 * steps; ++i) add(first + along * (i / (50.0 * steps)));
    }
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; j <= steps - i; ++j) {
        add(corners[0] + (i * (corners[1] - corners[0]) + j * (corners[2] - corners[0])) / steps);
      }
    }
    const double support =
        support_within(triangle_from_tip(corners, Vec3::Zero()), normal, 1.0, 1e-9);
    EXPECT_GE(support, most - 1e-12) << trial;
    if (most == -test::infinity) continue;  // a part may lie between the samples
    EXPECT_LE(support, most + 2.0 * spacing) << trial;
    ++parts;
  }
  EXPECT_GT(parts, 100);
}

}  // namespace
}  // namespace keepout
