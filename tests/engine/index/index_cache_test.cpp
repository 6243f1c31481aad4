// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/index_cache.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <thread>

#include "adapters/index_contract.h"
#include "keepout/error.h"
#include "small_surfaces.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

template <class T>
std::string bytes_of(std::span<const T> items) {
  return {reinterpret_cast<const char*>(items.data()), items.size_bytes()};
}

bool have_equal_blocks(const WideBvh& one, const WideBvh& other) {
  return bytes_of(one.nodes()) == bytes_of(other.nodes()) &&
         bytes_of(one.leaves()) == bytes_of(other.leaves()) &&
         one.coordinate_error() == other.coordinate_error();
}

/// A torus of 1152 triangles, so that nodes are below nodes, whose coordinates are no floats.
class IndexCache : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::shared_ptr<const Mesh> mesh = std::make_shared<const Mesh>(torus(24));
  WideBvh built{mesh};
  fs::path file = index_cache_file(*mesh, folder.path());
};

TEST_F(IndexCache, GivesBackTheIndexThatWasSaved) {
  ASSERT_TRUE(save_index(built, file));
  const auto loaded = load_index(mesh, file);
  ASSERT_NE(loaded, nullptr);
  EXPECT_TRUE(have_equal_blocks(*loaded, built));
}

TEST_F(IndexCache, BuildsOnceAndLoadsAfterwards) {
  const fs::path cache = folder.path() / "made" / "where_missing";
  EXPECT_TRUE(have_equal_blocks(*load_or_build(mesh, cache), built));
  const fs::path saved = index_cache_file(*mesh, cache);
  const auto time = fs::last_write_time(saved);
  ASSERT_EQ(std::distance(fs::directory_iterator(cache), {}), 1);
  EXPECT_TRUE(have_equal_blocks(*load_or_build(mesh, cache), built));
  EXPECT_EQ(fs::last_write_time(saved), time);
}

TEST_F(IndexCache, WhatIsDamagedIsBuiltAnewAndReplaced) {
  ASSERT_TRUE(save_index(built, file));
  const std::string good = bytes_of(file);
  std::ofstream(file, std::ios::binary) << good.substr(0, good.size() / 2);
  EXPECT_TRUE(have_equal_blocks(*load_or_build(mesh, folder.path()), built));
  EXPECT_EQ(bytes_of(file), good);
}

TEST_F(IndexCache, AFileCutShortOrGrownIsNotLoaded) {
  ASSERT_TRUE(save_index(built, file));
  const std::string good = bytes_of(file);
  for (std::size_t length = 0; length < good.size(); length += length < 120 ? 1 : 2977) {
    std::ofstream(file, std::ios::binary) << good.substr(0, length);
    ASSERT_EQ(load_index(mesh, file), nullptr) << length;
  }
  std::ofstream(file, std::ios::binary) << good << 'x';
  EXPECT_EQ(load_index(mesh, file), nullptr);
}

TEST_F(IndexCache, AFileWithAnyBitChangedIsNotLoaded) {
  ASSERT_TRUE(save_index(built, file));
  const std::string good = bytes_of(file);
  std::mt19937 random(1);
  for (int i = 0; i < 400; ++i) {
    // Bits all over the header, and some of the rest.
    const std::size_t bit = i < 200 ? random() % 1000 : random() % (8 * good.size());
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << bit % 8));
    std::ofstream(file, std::ios::binary) << bad;
    ASSERT_EQ(load_index(mesh, file), nullptr) << bit;
  }
}

TEST_F(IndexCache, AnotherMeshHasAnotherFileAndIsNotServedByThisOne) {
  ASSERT_TRUE(save_index(built, file));
  Surface surface = torus(24);
  surface.vertices[7].x() = std::nextafter(surface.vertices[7].x(), 0.0);
  std::vector<Surface> others{surface, flipped(torus(24)), shuffled(torus(24), 1), torus(25)};
  for (Surface& other : others) {
    const auto moved = std::make_shared<const Mesh>(std::move(other));
    EXPECT_NE(index_cache_file(*moved, folder.path()), file);
    EXPECT_EQ(load_index(moved, file), nullptr);
  }
}

TEST_F(IndexCache, WhereNothingCanBeWrittenTheIndexIsBuiltAllTheSame) {
  folder.write("occupied", "a file where the folder should be");
  EXPECT_TRUE(have_equal_blocks(*load_or_build(mesh, folder.path() / "occupied"), built));
  fs::create_directories(file / "occupied");
  EXPECT_TRUE(have_equal_blocks(*load_or_build(mesh, folder.path()), built));
  EXPECT_FALSE(save_index(built, folder.path() / "no" / "such.wide_bvh"));
  // Nothing is left of the attempts.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2);
}

TEST_F(IndexCache, ManyMayReadAndWriteAtOnce) {
  std::vector<int> good(4, 0);
  std::vector<std::thread> threads;
  for (int& count : good) {
    threads.emplace_back([&] {
      for (int i = 0; i < 30; ++i) {
        if (i % 5 == 4) fs::remove(file);
        count += have_equal_blocks(*load_or_build(mesh, folder.path()), built) ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int count : good) EXPECT_EQ(count, 30);
}

// Blocks that somebody made up, with all digests right.

class MadeUpBlocks : public IndexCache {
 protected:
  BlockVector<NodeBlock> nodes{built.nodes().begin(), built.nodes().end()};
  BlockVector<LeafBlock> leaves{built.leaves().begin(), built.leaves().end()};

  bool are_accepted() const {
    try {
      WideBvh(mesh, nodes, leaves);
      return true;
    } catch (const Error&) {
      return false;
    }
  }

  /// A node whose children are leaves.
  NodeBlock& lowest_node() { return nodes.back(); }
};

TEST_F(MadeUpBlocks, OfTheBuildAreAccepted) { EXPECT_TRUE(are_accepted()); }

TEST_F(MadeUpBlocks, ThatAreNoTreeAreRefused) {
  const BlockVector<NodeBlock> good = nodes;
  for (const std::uint32_t child :
       {std::uint32_t{1} << 30, NodeBlock::leaf | 0x7fffffffu, std::uint32_t{0}, NodeBlock::leaf}) {
    nodes = good;
    nodes[0].child[0] = child;
    EXPECT_FALSE(are_accepted()) << child;
  }
  nodes = good;
  nodes[0].child[1] = nodes[0].child[0];  // one twice, one never
  EXPECT_FALSE(are_accepted());
  nodes = good;
  nodes[1].child[0] = 1;  // its own parent
  EXPECT_FALSE(are_accepted());
  nodes = {};
  EXPECT_FALSE(are_accepted());
}

TEST_F(MadeUpBlocks, WithATreeTooDeepAreRefused) {
  // Each new root has the old as its only child: else a tree as good as before.
  for (std::size_t level = 2; level <= WideBvh::most_levels + 1; ++level) {
    for (NodeBlock& node : nodes) {
      for (std::uint32_t& child : node.child) {
        if (child != 0 && (child & NodeBlock::leaf) == 0) ++child;
      }
    }
    NodeBlock root = nodes[0];
    for (std::size_t lane = 0; lane < NodeBlock::lanes; ++lane) {
      for (int axis = 0; axis < 3; ++axis) {
        root.low[axis][lane] = lane == 0 ? -10.0F : std::numeric_limits<float>::max();
        root.high[axis][lane] = lane == 0 ? 10.0F : std::numeric_limits<float>::infinity();
      }
      root.child[lane] = lane == 0 ? 1 : 0;
    }
    nodes.insert(nodes.begin(), root);
    EXPECT_EQ(are_accepted(), level + 1 <= WideBvh::most_levels) << level;
  }
}

TEST_F(MadeUpBlocks, WithABoxThatDoesNotHoldWhatIsBelowAreRefused) {
  const BlockVector<NodeBlock> good = nodes;
  for (std::size_t n = 0; n < good.size(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      nodes = good;
      float& low = nodes[n].low[axis][0];
      // A box may be an ulp or two larger than what it holds.
      for (int ulp = 0; ulp < 3; ++ulp) low = std::nextafter(low, 100.0F);
      EXPECT_FALSE(are_accepted()) << n;
      nodes = good;
      float& high = nodes[n].high[axis][0];
      for (int ulp = 0; ulp < 3; ++ulp) high = std::nextafter(high, -100.0F);
      EXPECT_FALSE(are_accepted()) << n;
      nodes = good;
      nodes[n].high[axis][0] = std::numeric_limits<float>::quiet_NaN();
      EXPECT_FALSE(are_accepted()) << n;
    }
  }
}

TEST_F(MadeUpBlocks, WithOtherTrianglesThanTheMeshAreRefused) {
  const BlockVector<LeafBlock> good = leaves;
  const auto refuses = [&](auto&& change) {
    leaves = good;
    change(leaves[3]);
    return !are_accepted();
  };
  EXPECT_TRUE(refuses([](LeafBlock& leaf) { leaf.source[2] ^= LeafBlock::odd; }));
  EXPECT_TRUE(refuses([](LeafBlock& leaf) { leaf.source[2] = leaf.source[1]; }));
  EXPECT_TRUE(refuses([](LeafBlock& leaf) { leaf.source[2] = 1'000'000; }));
  EXPECT_TRUE(refuses([](LeafBlock& leaf) { leaf.source[15] = no_triangle; }));
  EXPECT_TRUE(refuses([](LeafBlock& leaf) { leaf.corner[1][2][0] += 1e-3F; }));
  EXPECT_TRUE(refuses([](LeafBlock& leaf) {
    std::swap(leaf.corner[0], leaf.corner[1]);  // not in lexicographic order
  }));
  leaves = good;
  leaves.pop_back();
  EXPECT_FALSE(are_accepted());
}

TEST_F(MadeUpBlocks, ThatAreAcceptedFindWhatBruteForceFinds) {
  // Whatever is changed: it is refused, or harmless.
  std::mt19937 random(2);
  const BlockVector<NodeBlock> good_nodes = nodes;
  const BlockVector<LeafBlock> good_leaves = leaves;
  const std::vector<Vec3> points = probing_points(*mesh, 1);
  int accepted = 0;
  for (int i = 0; i < 3000; ++i) {
    nodes = good_nodes;
    leaves = good_leaves;
    auto* bytes = reinterpret_cast<unsigned char*>(nodes.data());
    std::size_t size = nodes.size() * sizeof(NodeBlock);
    if (i % 4 == 0) {
      bytes = reinterpret_cast<unsigned char*>(leaves.data());
      size = leaves.size() * sizeof(LeafBlock);
    }
    const std::size_t bit = random() % (8 * size);
    bytes[bit / 8] = static_cast<unsigned char>(bytes[bit / 8] ^ (1 << bit % 8));
    if (!are_accepted()) continue;
    ++accepted;
    const WideBvh index(mesh, nodes, leaves);
    const Vec3& point = points[random() % points.size()];
    const std::vector<double> all = distances(*mesh, point);
    const double radius = *std::min_element(all.begin(), all.end()) + 0.5;
    TriangleBuffer found(mesh->triangle_count());
    index.collect({point, radius}, found);
    const auto touching =
        std::count_if(all.begin(), all.end(), [&](double d) { return d <= radius; });
    ASSERT_EQ(static_cast<std::ptrdiff_t>(found.size()), touching);
  }
  EXPECT_GT(accepted, 0);  // boxes that have grown
}

}  // namespace
}  // namespace keepout
