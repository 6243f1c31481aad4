// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/wide_bvh.h"

#include <cmath>
#include <cstring>
#include <numbers>
#include <set>

#include "engine/index/exact_index.h"
#include "keepout/error.h"
#include "meshes.h"

namespace keepout {
namespace {

/// Fails unless every box of the subtree contains its triangles, and each child comes after its
/// parent. Appends the leaves of the subtree.
void expect_boxes_hold(const WideBvh::Tree& index, std::size_t self,
                       std::vector<std::size_t>& leaves) {
  const NodeBlock& node = index.nodes()[self];
  bool rest_unused = false;
  for (std::size_t lane = 0; lane < NodeBlock::lanes; ++lane) {
    rest_unused = rest_unused || !node.is_used(lane);
    ASSERT_EQ(node.is_used(lane), !rest_unused) << "a gap";
    if (rest_unused) {
      for (int axis = 0; axis < 3; ++axis) ASSERT_TRUE(std::isinf(node.low[axis][lane]));
      continue;
    }
    const std::size_t first = leaves.size();
    if ((node.child[lane] & NodeBlock::leaf_bit) != 0) {
      leaves.push_back(node.child[lane] & ~NodeBlock::leaf_bit);
    } else {
      ASSERT_GT(node.child[lane], self);
      ASSERT_LT(node.child[lane], index.nodes().size());
      expect_boxes_hold(index, node.child[lane], leaves);
    }
    for (std::size_t i = first; i < leaves.size(); ++i) {
      const LeafBlock& leaf = index.leaves()[leaves[i]];
      for (std::size_t t = 0; t < LeafBlock::lanes && leaf.is_used(t); ++t) {
        for (const Vec3& corner : index.mesh().triangle(leaf.triangle(t))) {
          for (int axis = 0; axis < 3; ++axis) {
            const double x = corner[axis] - index.frame().origin[axis];
            ASSERT_LE(node.low[axis][lane], x);
            ASSERT_GE(node.high[axis][lane], x);
          }
        }
      }
    }
  }
}

void expect_sound(const WideBvh::Tree& index) {
  expect_leaves_hold(index.mesh(), index);
  std::vector<std::size_t> leaves;
  expect_boxes_hold(index, 0, leaves);
  ASSERT_EQ(leaves.size(), index.leaves().size());
  for (std::size_t i = 0; i < leaves.size(); ++i) ASSERT_EQ(leaves[i], i) << "not in their order";
}

TEST(WideBvh, BoxesHoldTheirTrianglesAndEveryTriangleIsThereOnce) {
  for (const char* name : {"cortex", "needles", "far_cube", "fan"}) {
    SCOPED_TRACE(name);
    expect_sound(WideBvh(mesh_of(name)).tree());
    if (HasFatalFailure()) return;
  }
}

TEST(WideBvh, CylindersHoldTheirTriangles) {
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    expect_cylinders_hold(WideBvh(mesh_of(shape.name)).tree());
    if (HasFatalFailure()) return;
  }
  for (const double scale : {1e-30, 1e-12, 1e-6, 1e6, 1e16, 1e22}) {
    for (const double offset : {0.0, 1e6}) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << " offset " << offset);
      const auto mesh = moved(*mesh_of("gear"), [&](const Vec3& v) -> Vec3 {
        return scale * (v + offset * Vec3(1.0, -0.7, 0.3));
      });
      expect_cylinders_hold(WideBvh(mesh).tree());
      if (HasFatalFailure()) return;
    }
  }
}

bool are_equal(const WideBvh::Tree& one, const WideBvh::Tree& other) {
  const auto equal = [](auto a, auto b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
  };
  return equal(one.nodes(), other.nodes()) && equal(one.leaves(), other.leaves()) &&
         equal(one.cylinders(), other.cylinders()) && one.frame().error == other.frame().error &&
         one.frame().origin == other.frame().origin;
}

TEST(WideBvh, IsTheSameTreeWhateverTheNumberOfThreads) {
  const auto mesh = mesh_of(make_cortex(0.7, 1));
  ASSERT_GT(mesh->triangle_count(), 30'000u);
  const WideBvh alone(mesh, 1);
  for (const unsigned threads : {2u, 3u, 8u, 16u}) {
    EXPECT_TRUE(are_equal(alone.tree(), WideBvh(mesh, threads).tree())) << threads << " threads";
  }
}

Vec3 twisted(const Vec3& v) {
  const double angle = 0.3 + 0.01 * v.z();
  return {std::cos(angle) * v.x() - std::sin(angle) * v.y(),
          std::sin(angle) * v.x() + std::cos(angle) * v.y(), 1.1 * v.z() + 0.1 * v.x()};
}

TEST(WideBvh, IsExactAfterARefitToMovedVertices) {
  for (const char* name : {"cortex", "gear", "triangle_soup"}) {
    SCOPED_TRACE(name);
    const auto before = mesh_of(name);
    const auto after = moved(*before, twisted);
    for (const unsigned threads : {1u, 3u}) {
      WideBvh index(before);
      index.refit(after, threads);
      EXPECT_EQ(&index.mesh(), after.get());
      expect_sound(index.tree());
      expect_cylinders_hold(index.tree());
      expect_exact(*after, index, 5);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(WideBvh, ARefitAndBackIsTheTreeThatWas) {
  const auto mesh = mesh_of("cortex");
  const WideBvh was(mesh);
  WideBvh index(mesh);
  index.refit(moved(*mesh, twisted));
  EXPECT_FALSE(are_equal(index.tree(), was.tree()));
  index.refit(mesh);
  EXPECT_TRUE(are_equal(index.tree(), was.tree()));
}

/// Tests leaves with few and with many vertices, coordinates that are floats and coordinates that
/// are not, and -0.
TEST(WideBvh, ARefitIsTheTreeThatIsBuiltInTheSameOrder) {
  for (const Shape& shape : shapes_to_try()) {
    SCOPED_TRACE(shape.name);
    const auto before = mesh_of(shape.name);
    for (const double unit : {0.0, 1.0, 0.25}) {  // 0: not rounded
      const auto after = moved(*before, [&](const Vec3& v) -> Vec3 {
        return unit == 0.0 ? twisted(v) : Vec3(unit * (twisted(v) / unit).array().round());
      });
      WideBvh index(before);
      index.refit(after);
      index.refit(before);  // the tables of the first refit are used again
      EXPECT_TRUE(are_equal(index.tree(), WideBvh(before, WideBvh(before).order()).tree()));
      index.refit(after);
      EXPECT_TRUE(are_equal(index.tree(), WideBvh(after, index.order()).tree()));
    }
  }
}

/// Tests corners whose order is lost in floats.
TEST(WideBvh, CornersKeepTheOrderOfTheirDoublesAfterARefit) {
  const auto before = mesh_of("cortex");
  std::size_t ties = 0;
  const auto after = moved(*before, [](const Vec3& v) -> Vec3 {
    return {std::round(v.x()) - 1e-12 * v.y(), v.y() + 1e-3, v.z()};
  });
  for (TriangleId t = 0; t < after->triangle_count(); ++t) {
    const Triangle triangle = after->triangle(t);
    const double between = triangle[0].x() - triangle[1].x();
    ties += between != 0.0 && std::abs(between) < 1e-9 ? 1 : 0;
  }
  ASSERT_GT(ties, after->triangle_count() / 10);
  WideBvh index(before);
  for (int i = 0; i < 2; ++i) {
    index.refit(after);
    ASSERT_FALSE(index.tree().frame().is_exact());
    expect_sound(index.tree());
    index.refit(before);
  }
  expect_sound(WideBvh(after).tree());
}

TEST(WideBvh, ARefitIsTheSameWhateverTheNumberOfThreads) {
  const auto mesh = mesh_of(make_cortex(0.7, 1));
  const auto after = moved(*mesh, twisted);
  WideBvh alone(mesh, 1);
  alone.refit(after, 1);
  for (const unsigned threads : {2u, 3u, 8u}) {
    WideBvh index(mesh);
    index.refit(after, threads);
    EXPECT_TRUE(are_equal(alone.tree(), index.tree())) << threads << " threads";
  }
}

TEST(WideBvh, RefusesToBeRefitToOtherTriangles) {
  const auto mesh = mesh_of("gear");
  const WideBvh was(mesh);
  WideBvh index(mesh);
  Surface other = surface_of(*mesh);
  std::swap(other.triangles.back()[0], other.triangles.back()[1]);
  EXPECT_THROW(index.refit(mesh_of(other)), Error);
  EXPECT_THROW(index.refit(mesh_of(opened(other))), Error);
  Surface more = surface_of(*mesh);
  more.vertices.push_back(Vec3::Zero());
  EXPECT_THROW(index.refit(mesh_of(more)), Error);
  EXPECT_TRUE(are_equal(index.tree(), was.tree()));
  EXPECT_EQ(&index.mesh(), mesh.get());
}

/// Collects the triangles that a traversal shows.
class Shown final : public TriangleVisitor {
 public:
  double visit(TriangleId triangle, std::uint32_t&, const Triangle*) noexcept override {
    triangles.insert(triangle);
    return MotionTraversal::never;
  }

  std::set<TriangleId> triangles;
};

TEST(WideBvh, ATraversalCountsEachLeafThatItFills) {
  const auto mesh = mesh_of("gear");
  const WideBvh index(mesh);
  const Vec3 tip = mesh->vertex(0), motion(2.0, 0.0, 0.0);
  Budget budget;
  const auto traversal = index.traverse_along_motions(budget);
  ASSERT_TRUE(traversal->begin({tip, {tip, 12.0}, 10.0, 2.0}));
  Shown shown;
  const auto spent_on_it = [&] {
    const std::size_t before = budget.spent();
    traversal->traversal(motion, shown);
    return budget.spent() - before;
  };
  const std::size_t first = spent_on_it();
  std::set<std::size_t> leaves;  // with triangles that were shown; more may have been filled
  for (std::size_t i = 0; i < index.tree().leaves().size(); ++i) {
    const LeafBlock& leaf = index.tree().leaves()[i];
    for (std::size_t lane = 0; lane < LeafBlock::lanes && leaf.is_used(lane); ++lane) {
      if (shown.triangles.contains(leaf.triangle(lane))) leaves.insert(i);
    }
  }
  ASSERT_GT(leaves.size(), 5u);
  // The second traversal does all the same, but finds the leaves filled.
  EXPECT_GE(first, spent_on_it() + leaves.size() * work::leaf);
}

TEST(WideBvh, ATraversalShowsAllOfThousandsOfPatchesThatWaitForTheirTime) {
  // Patches at random heights: each box of many patches is reached early, and each patch later.
  constexpr int across = 120;
  Random random(7);
  Surface surface;
  for (int patch = 0; patch < across * across; ++patch) {
    const Vec3 middle(patch % across, patch / across, random.uniform(0.0, 4.0));
    const auto first = static_cast<VertexId>(surface.vertices.size());
    surface.vertices.push_back(middle);
    for (int corner = 0; corner < 16; ++corner) {
      const double angle = corner * std::numbers::pi / 8.0;
      surface.vertices.push_back(middle + 0.2 * Vec3(std::cos(angle), std::sin(angle), 0.0));
      const auto next = static_cast<VertexId>((corner + 1) % 16);
      surface.triangles.push_back(
          {first, first + 1 + static_cast<VertexId>(corner), first + 1 + next});
    }
  }
  const auto mesh = mesh_of(std::move(surface));
  const WideBvh index(mesh);
  constexpr double level = 2000.0;
  const Vec3 tip(0.5 * across, 0.5 * across, level + 4.1), motion(0.0, 0.0, -8.0);
  Budget budget;
  const auto traversal = index.traverse_along_motions(budget);
  ASSERT_TRUE(traversal->begin({tip, {tip, 8.0 + level}, level, 8.0}));
  Shown shown;
  traversal->traversal(motion, shown);
  EXPECT_EQ(shown.triangles.size(), mesh->triangle_count());
}

}  // namespace
}  // namespace keepout
