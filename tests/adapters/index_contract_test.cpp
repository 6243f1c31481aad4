// SPDX-License-Identifier: BSD-3-Clause
// Every index returns all triangles that brute force returns, for any point and radius.
#include "adapters/index_contract.h"

#include <future>
#include <set>

#include "index_module.h"
#include "keepout/adapters/index_registry.h"
#include "messages.h"

namespace keepout {
namespace {

/// Returns a lower bound of a segment's distance from a triangle: the distance of their boxes.
double distance_to_box_around(const Triangle& corners, const Vec3& from, const Vec3& to) {
  const Vec3 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
  const Vec3 high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
  return (low - from.cwiseMax(to)).cwiseMax(from.cwiseMin(to) - high).cwiseMax(0.0).norm();
}

class IndexContract : public testing::TestWithParam<IndexBackend> {};

TEST_P(IndexContract, FindsWhatBruteForceFindsOnEveryGeneratedShape) {
  if (GetParam().name == "brute_force") return;  // is the reference
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    const auto mesh = mesh_of(shape.make());
    expect_brute_force_sets(*mesh, *GetParam().make(mesh), probes(*mesh, 20));
    if (HasFatalFailure()) return;
  }
}

// Indices in single precision or with absolute tolerances may fail for some positions and sizes of
// a mesh.
TEST_P(IndexContract, FindsWhatBruteForceFindsWhereverTheMeshIsAndHoweverLarge) {
  if (GetParam().name == "brute_force") return;  // is the reference
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

// The triangles shrink towards one point. A tree that splits at the mean gets as many levels as
// triangles.
TEST_P(IndexContract, FindsWhatBruteForceFindsOnAMeshOfEverySize) {
  if (GetParam().name == "brute_force") return;  // is the reference
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

// The computed normal of a needle consists of rounding errors, so its plane is arbitrary.
TEST_P(IndexContract, FindsWhatBruteForceFindsOnNeedles) {
  if (GetParam().name == "brute_force") return;  // is the reference
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

// Instruments query the triangles near a shaft. The reference distance is that of the narrow phase,
// which has no special case for segments.
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

// If an index dropped triangles without a report, the instrument could move into them.
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
  if (GetParam().name == "brute_force") return;  // returns exact results
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

TEST_P(IndexContract, SaysWhetherItWalksAlongMotions) {
  const auto index = GetParam().make(std::make_shared<const Mesh>(make_cube(50)));
  Budget budget;
  EXPECT_EQ(index->traverses(), index->traverse_along_motions(budget) != nullptr);
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

std::string backend_name(const testing::TestParamInfo<IndexBackend>& info) {
  return std::string(info.param.name);
}

INSTANTIATE_TEST_SUITE_P(Backends, IndexContract, testing::ValuesIn(index_backends()),
                         backend_name);

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
  // All known indices are either present or absent.
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
