// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The tests that every index must pass, for the rows of an index registry or of a plugin:
//
//     using keepout::IndexContract;
//     INSTANTIATE_TEST_SUITE_P(Mine, IndexContract, testing::ValuesIn(keepout_indices),
//     keepout::by_name);

#include <future>
#include <set>

#include "keepout/activation/registry.h"
#include "keepout/geometry/convex_tool.h"
#include "keepout/geometry/separation.h"
#include "keepout/index/brute_force.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"
#include "keepout/testing/index_probes.h"

namespace keepout {

/// Returns a lower bound of the distance from a segment to a triangle: that of their boxes.
inline double distance_to_box_around(const Triangle& corners, const Vec3& from, const Vec3& to) {
  const Vec3 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
  const Vec3 high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
  return (low - from.cwiseMax(to)).cwiseMax(from.cwiseMin(to) - high).cwiseMax(0.0).norm();
}

/// Collects the triangles that a traversal shows, and checks their corners and notes.
class ShownTriangles final : public TriangleVisitor {
 public:
  ShownTriangles(const Mesh& mesh, const Vec3& tip) : mesh_(mesh), tip_(tip) {}

  /// Begins a motion. `latest`: the fraction that each visit returns.
  void start(double latest) {
    latest_ = latest;
    triangles_.clear();
  }

  double visit(TriangleId triangle, std::uint32_t& note,
               const Triangle* corners) noexcept override {
    if (triangle >= mesh_.triangle_count() ||
        (note == MotionTraversal::no_note) != (corners != nullptr)) {
      contradicts_ = true;
    } else if (corners != nullptr) {
      contradicts_ |= *corners != ordered_relative(mesh_.triangle(triangle), tip_);
    } else {
      contradicts_ |= note != triangle;
    }
    note = triangle;
    triangles_.insert(triangle);
    return latest_;
  }

  const std::set<TriangleId>& triangles() const noexcept { return triangles_; }
  /// Returns true if the corners or the note of a triangle were wrong.
  bool contradicts() const noexcept { return contradicts_; }

 private:
  const Mesh& mesh_;
  Vec3 tip_;
  double latest_ = MotionTraversal::never;
  std::set<TriangleId> triangles_;
  bool contradicts_ = false;
};

/// The requirements on an index, compared with brute force. Instantiate it in one source.
class IndexContract : public testing::TestWithParam<IndexBackend> {};

TEST_P(IndexContract, FindsWhatBruteForceFindsOnEveryGeneratedShape) {
  if (GetParam().name == "brute_force") return;  // is what the others are held to
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    const auto mesh = mesh_of(shape.make());
    expect_brute_force_sets(*mesh, *GetParam().make(mesh), probes(*mesh, 20));
    if (HasFatalFailure()) return;
  }
}

// Indices in float, or with absolute tolerances, are put to the test by where and how large a mesh
// is.
TEST_P(IndexContract, FindsWhatBruteForceFindsWhereverTheMeshIsAndHoweverLarge) {
  if (GetParam().name == "brute_force") return;  // is what the others are held to
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const double offset : {0.0, 1e6}) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << " offset " << offset);
      Surface surface = make_shape("gear");
      for (Vec3& vertex : surface.vertices) {
        vertex = scale * vertex + offset * Vec3(1.0, -0.7, 0.3);
      }
      const auto mesh = mesh_of(std::move(surface));
      expect_brute_force_sets(*mesh, *GetParam().make(mesh), probes(*mesh, 5));
      if (HasFatalFailure()) return;
    }
  }
}

// Ever smaller towards one point: a tree that splits at the mean is as deep as the list is long.
TEST_P(IndexContract, FindsWhatBruteForceFindsOnAMeshOfEverySize) {
  if (GetParam().name == "brute_force") return;  // is what the others are held to
  Surface surface;
  for (int i = 0; i < 900; ++i) {
    const double size = std::ldexp(1.0, -i);
    const auto first = static_cast<VertexId>(surface.vertices.size());
    for (const Vec3& corner : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 0, 1)}) {
      surface.vertices.push_back(size * corner);
    }
    surface.triangles.push_back({first, first + 1, first + 2});
  }
  const auto mesh = mesh_of(std::move(surface));
  expect_brute_force_sets(*mesh, *GetParam().make(mesh), probes(*mesh, 20));
}

// The normal of a needle is all rounding: a plane through it may be anywhere.
TEST_P(IndexContract, FindsWhatBruteForceFindsOnNeedles) {
  if (GetParam().name == "brute_force") return;  // is what the others are held to
  Random random(4);
  Surface surface;
  for (const double width : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15}) {
    for (int i = 0; i < 100; ++i) {
      const Vec3 start = 10.0 * random.direction();
      const Vec3 way = random.direction();
      const Vec3 aside = start + random.uniform() * way + width * random.direction();
      const auto first = static_cast<VertexId>(surface.vertices.size());
      surface.vertices.insert(surface.vertices.end(), {start, start + way, aside});
      surface.triangles.push_back({first, first + 1, first + 2});
    }
  }
  const auto mesh = mesh_of(std::move(surface));
  expect_brute_force_sets(*mesh, *GetParam().make(mesh), probes(*mesh, 50));
}

TEST_P(IndexContract, FindsWhatBruteForceFindsOnOneTriangleAndOnManyInOnePlace) {
  const Surface one{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}}};
  Surface many = one;
  many.triangles.assign(5000, {0, 1, 2});
  for (const Surface& surface : {one, many}) {
    const auto mesh = mesh_of(surface);
    expect_brute_force_sets(*mesh, *GetParam().make(mesh), probes(*mesh, 10));
  }
}

TEST_P(IndexContract, FindsTrianglesThatAreAllOnePoint) {
  const Vec3 place(1e3, -2e3, 3e3);
  for (const std::size_t count : {1u, 2u, 1000u}) {
    Surface points{{place}, {}};
    points.triangles.assign(count, {0, 0, 0});
    const auto mesh = mesh_of(points);
    const auto index = GetParam().make(mesh);
    TriangleBuffer candidates(count);
    for (const Ball& ball : {Ball{place, 0.0}, Ball{place, 1.0}, Ball{place + Vec3(0, 0, 5), 5.0},
                             Ball{place + Vec3(3e4, 4e4, 0), 5e4}}) {
      candidates.clear();
      index->collect(ball, candidates);
      EXPECT_EQ(candidates.size(), count) << "radius " << ball.radius;
      EXPECT_FALSE(candidates.overflowed());
    }
  }
}

// For a whole instrument: what is near a shaft. The distance of reference is the narrow phase's,
// which knows nothing of segments.
TEST_P(IndexContract, FindsAllThatIsNearACapsuleOnceEach) {
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    const auto mesh = mesh_of(shape.make());
    const auto index = GetParam().make(mesh);
    Random random(11);
    const double size = mesh->bounds().size().norm();
    TriangleBuffer candidates(mesh->triangle_count());
    const std::vector<Vec3> points = probing_points(*mesh, 4);
    for (const Vec3& from : points) {
      const double length = size * std::pow(10.0, random.uniform(-4.0, 0.0));
      const Vec3 to = random.below(8) == 0 ? from : Vec3(from + length * random.direction());
      const double radius =
          random.below(8) == 0 ? 0.0 : size * std::pow(10.0, random.uniform(-5, -1));
      candidates.clear();
      index->collect_near({from, to, radius}, candidates);
      ASSERT_FALSE(candidates.overflowed());
      const std::set<TriangleId> found(candidates.begin(), candidates.end());
      ASSERT_EQ(found.size(), candidates.size()) << "once each";
      const ConvexTool tool = ConvexTool::hull(std::vector<Vec3>{Vec3::Zero(), to - from});
      for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
        const Triangle corners = mesh->triangle(t);
        if (found.contains(t) || distance_to_box_around(corners, from, to) > radius) continue;
        ASSERT_GT(separation(tool, from, corners).distance, radius * (1.0 - 1e-12) - 1e-12 * size);
      }
    }
  }
}

// A motion could hit triangles that are left out without a report.
TEST_P(IndexContract, SaysThatThereIsMoreNearACapsuleThanThereIsRoomFor) {
  const auto mesh = mesh_of(make_cube(25.0));
  const auto index = GetParam().make(mesh);
  const std::size_t count = mesh->triangle_count();
  for (const double radius : {1.0, 30.0, 200.0}) {
    const Capsule along_an_edge{Vec3(50, 50, -50), Vec3(50, 50, 50), radius};
    TriangleBuffer all(count);
    index->collect_near(along_an_edge, all);
    for (const std::size_t room : {std::size_t{1}, all.size() / 2, all.size() - 1}) {
      TriangleBuffer few(room);
      index->collect_near(along_an_edge, few);
      EXPECT_TRUE(few.overflowed()) << "radius " << radius << ", room " << room;
    }
  }
}

TEST_P(IndexContract, ABallThatHoldsTheMeshFindsAllOfIt) {
  const auto mesh = mesh_of("cube");
  const auto index = GetParam().make(mesh);
  const double size = mesh->bounds().size().norm();
  TriangleBuffer candidates(mesh->triangle_count());
  for (const double away : {0.0, 1.0, 1e4, 1e12, 1e100}) {
    for (const double farther : {1.001, 1e3, 1e20}) {
      candidates.clear();
      index->collect({away * size * Vec3(0.6, 0.8, 0), farther * (away + 1.0) * size}, candidates);
      EXPECT_EQ(candidates.size(), mesh->triangle_count()) << away << " sizes away";
      EXPECT_FALSE(candidates.overflowed());
    }
  }
}

TEST_P(IndexContract, ProposesLittleWhereThereIsLittle) {
  if (GetParam().name == "brute_force") return;  // proposes what is there, and nothing else
  const auto mesh = mesh_of("star_bumps");
  const auto index = GetParam().make(mesh);
  TriangleBuffer candidates(mesh->triangle_count());
  Random random(3);
  for (const Vec3& point : surface_points(*mesh, 50, 0.0, random)) {
    candidates.clear();
    index->collect({point, 1e-3}, candidates);
    EXPECT_GE(candidates.size(), 1u);
    EXPECT_LE(candidates.size(), mesh->triangle_count() / 20);
  }
}

TEST_P(IndexContract, SaysHowMuchMemoryItHolds) {
  const auto mesh = mesh_of("star_bumps");
  const double of_each = static_cast<double>(GetParam().make(mesh)->memory()) /
                         static_cast<double>(mesh->triangle_count());
  if (GetParam().name == "brute_force") {
    EXPECT_EQ(of_each, 0.0);
  } else {
    EXPECT_GT(of_each, 20.0);
    EXPECT_LT(of_each, 1000.0);
  }
}

TEST_P(IndexContract, SaysWhatItHoldsAtMostAndWhatLibraryIsBehindIt) {
  EXPECT_GE(GetParam().most_triangles, std::size_t{1} << 26);
  EXPECT_FALSE(GetParam().description.empty());
  if (GetParam().library == nullptr) return;  // ours
  const std::string library = GetParam().library();
  EXPECT_NE(library.find_first_of("0123456789"), std::string::npos) << library;
}

TEST_P(IndexContract, SaysWhetherItTraversesAlongMotions) {
  const auto index = GetParam().make(std::make_shared<const Mesh>(make_cube(50)));
  Budget budget;
  EXPECT_EQ(index->traverses(), index->traverse_along_motions(budget) != nullptr);
}

TEST_P(IndexContract, ATraversalShowsEveryTriangleThatAMotionComesNear) {
  if (!GetParam().make(mesh_of("cube"))->traverses()) return;
  std::size_t seen = 0, clear = 0;
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    const auto mesh = mesh_of(shape.make());
    const auto index = GetParam().make(mesh);
    Budget budget;
    const auto traversal = index->traverse_along_motions(budget);
    const double size = mesh->bounds().size().norm();
    Random random(12);
    for (const double offset : {0.0, 0.5, 1.01, 2.0}) {
      const double level = size * std::pow(10.0, random.uniform(-4.0, -1.4));
      // Towards the surface in small steps, so that it matters what the traversal remembers.
      const double longest = level * std::pow(10.0, random.uniform(-1.0, 0.5));
      const Vec3 ahead = random.direction();
      Vec3 tip = surface_points(*mesh, 1, offset * level, random)[0] - 2.0 * longest * ahead;
      for (int cycle = 0; cycle < 12; ++cycle) {
        tip += 0.2 * longest * ahead;
        ASSERT_TRUE(traversal->begin({tip, {tip, longest + level}, level, longest}));
        const bool is_empty = traversal->region_is_empty();
        ShownTriangles shown(*mesh, tip);
        for (const double part : {1.0, 0.5, 0.1}) {
          const Vec3 motion = part * longest * (part == 1.0 ? ahead : random.direction());
          bool nothing_near = is_empty;
          shown.start(MotionTraversal::never);
          if (!is_empty) nothing_near = traversal->traversal(motion, shown);
          const std::set<TriangleId> along = shown.triangles();
          shown.start(-1.0);  // from now on, only triangles near the start matter
          if (!is_empty) traversal->traversal(motion, shown);
          ASSERT_FALSE(shown.contradicts());
          const ConvexTool segment = ConvexTool::hull(std::vector<Vec3>{Vec3::Zero(), motion});
          for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
            const Triangle corners = mesh->triangle(t);
            if (distance_to_box_around(corners, tip, tip + motion) > level) continue;
            const double surely = level * (1.0 - 1e-9) - 1e-12 * size;
            if (separation(segment, tip, corners).distance > surely) continue;
            ASSERT_TRUE(along.contains(t)) << t << " of a motion from " << tip.transpose();
            ASSERT_FALSE(nothing_near);
            if (closest_point(corners, tip).distance > surely) continue;
            ASSERT_TRUE(shown.triangles().contains(t)) << t << " at " << tip.transpose();
          }
          seen += along.size();
          clear += nothing_near ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(seen, 1000u);
  EXPECT_GT(clear, 50u);
}

TEST_P(IndexContract, ATraversalSpendsWorkAndStopsWithoutBudget) {
  const auto mesh = mesh_of("star_bumps");
  const auto index = GetParam().make(mesh);
  if (!index->traverses()) return;
  const Vec3 tip = mesh->vertex(0);
  const double near = 5.0;  // of a shape 100 mm large: many triangles
  Budget enough, few(1);
  for (Budget* budget : {&enough, &few}) {
    const auto traversal = index->traverse_along_motions(*budget);
    ShownTriangles shown(*mesh, tip);
    shown.start(MotionTraversal::never);
    if (traversal->begin({tip, {tip, 2.0 * near}, near, near})) {
      traversal->traversal(Vec3(near, 0.0, 0.0), shown);
    }
    if (budget == &enough) {
      EXPECT_GT(budget->spent(), 2u);
      EXPECT_GT(shown.triangles().size(), 20u);
    } else {
      EXPECT_TRUE(budget->is_spent());
      EXPECT_LT(shown.triangles().size(), 20u);
    }
  }
}

TEST_P(IndexContract, StepsAreThoseOfBruteForce) {
  if (GetParam().name == "brute_force") return;
  for (const std::string_view shape : {"star_bumps", "gear"}) {
    const auto mesh = mesh_of(shape);
    const auto guard_of = [&](std::shared_ptr<const SpatialIndex> index) {
      return MotionConstraint(mesh, std::move(index), make_activation("certified"),
                              make_solver("active_set"), {.radius = 1.0, .margin = 0.5});
    };
    MotionConstraint guard = guard_of(GetParam().make(mesh));
    MotionConstraint expected = guard_of(std::make_shared<BruteForce>(mesh));
    Random random(13);
    std::size_t limited = 0;
    for (Vec3 tip : surface_points(*mesh, test::trials<std::size_t>(40), 0.6, random)) {
      const Vec3 press = random.direction();
      for (int cycle = 0; cycle < 20; ++cycle) {
        const Motion motion{.tip = tip, .desired = 0.2 * (press + random.direction())};
        const Step step = guard.step(motion);
        const Step right = expected.step(motion);
        ASSERT_EQ(step.status, right.status) << shape << " at " << tip.transpose();
        ASSERT_EQ(step.motion, right.motion) << shape << " at " << tip.transpose();
        limited += step.status == Status::limited ? 1 : 0;
        tip += step.motion;
      }
    }
    EXPECT_GT(limited, 20u);
  }
}

TEST_P(IndexContract, NeverGivesATriangleTwice) {
  const auto mesh = mesh_of("star_bumps");
  const auto index = GetParam().make(mesh);
  TriangleBuffer candidates(mesh->triangle_count());
  index->collect({mesh->bounds().center(), mesh->bounds().size().norm()}, candidates);
  ASSERT_EQ(candidates.size(), mesh->triangle_count());
  std::sort(candidates.begin(), candidates.end());
  EXPECT_EQ(std::adjacent_find(candidates.begin(), candidates.end()), candidates.end());
}

TEST_P(IndexContract, ManyThreadsMayAskAtOnce) {
  const auto mesh = mesh_of("star_bumps");
  const auto index = GetParam().make(mesh);
  const auto found = [&](std::uint64_t seed) {
    TriangleBuffer candidates(mesh->triangle_count());
    Random random(seed);
    std::vector<TriangleId> all;
    for (const Vec3& point : surface_points(*mesh, 50, 1.0, random)) {
      candidates.clear();
      index->collect({point, 5.0}, candidates);
      all.insert(all.end(), candidates.begin(), candidates.end());
    }
    return all;
  };
  std::vector<std::future<std::vector<TriangleId>>> answers;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    answers.push_back(std::async(std::launch::async, found, seed));
  }
  for (std::uint64_t seed = 0; seed < 4; ++seed) EXPECT_EQ(answers[seed].get(), found(seed));
}

TEST_P(IndexContract, ManyThreadsMayBuildAtOnce) {
  const auto mesh = mesh_of("cube");
  const auto found = [&] {
    TriangleBuffer candidates(mesh->triangle_count());
    GetParam().make(mesh)->collect({mesh->bounds().high, 10.0}, candidates);
    std::sort(candidates.begin(), candidates.end());
    return std::vector<TriangleId>(candidates.begin(), candidates.end());
  };
  std::vector<std::future<std::vector<TriangleId>>> answers;
  for (int i = 0; i < 4; ++i) answers.push_back(std::async(std::launch::async, found));
  const std::vector<TriangleId> alone = found();
  for (auto& answer : answers) EXPECT_EQ(answer.get(), alone);
}

TEST_P(IndexContract, SaysWhenTheBufferIsTooSmall) {
  const auto mesh = mesh_of("cube");
  TriangleBuffer candidates(3);
  GetParam().make(mesh)->collect({mesh->bounds().center(), 1e3}, candidates);
  EXPECT_TRUE(candidates.overflowed());
}

}  // namespace keepout
