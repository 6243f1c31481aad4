// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/index_cache.h"

#include <random>
#include <thread>

#include "index/wide_bvh/tree.h"
#include "keepout/testing/index_probes.h"
#include "meshes.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

namespace fs = std::filesystem;

template <class T>
std::string bytes_of(std::span<const T> items) {
  return {reinterpret_cast<const char*>(items.data()), items.size_bytes()};
}

bool have_equal_blocks(const WideBvh::Tree& one, const WideBvh::Tree& other) {
  return bytes_of(one.nodes()) == bytes_of(other.nodes()) &&
         bytes_of(one.leaves()) == bytes_of(other.leaves()) &&
         one.frame().error == other.frame().error && one.frame().origin == other.frame().origin;
}

/// A torus of 1152 triangles: its tree has several levels, and its coordinates are not floats.
class IndexCache : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::shared_ptr<const Mesh> mesh = mesh_of(torus(24));
  WideBvh built{mesh};
  fs::path file = index_cache_file(*mesh, folder.path());
};

TEST_F(IndexCache, GivesBackTheIndexThatWasSaved) {
  ASSERT_TRUE(save_index(built, file));
  const auto loaded = load_index(mesh, file);
  ASSERT_NE(loaded, nullptr);
  EXPECT_TRUE(have_equal_blocks(loaded->tree(), built.tree()));
}

TEST_F(IndexCache, BuildsOnceAndLoadsAfterwards) {
  const fs::path cache = folder.path() / "made" / "where_missing";
  EXPECT_TRUE(have_equal_blocks(load_or_build(mesh, cache)->tree(), built.tree()));
  const fs::path saved = index_cache_file(*mesh, cache);
  const auto time = fs::last_write_time(saved);
  ASSERT_EQ(std::distance(fs::directory_iterator(cache), {}), 1);
  EXPECT_TRUE(have_equal_blocks(load_or_build(mesh, cache)->tree(), built.tree()));
  EXPECT_EQ(fs::last_write_time(saved), time);
}

TEST_F(IndexCache, WhatIsDamagedIsBuiltAnewAndReplaced) {
  ASSERT_TRUE(save_index(built, file));
  const std::string good = contents_of(file);
  std::ofstream(file, std::ios::binary) << good.substr(0, good.size() / 2);
  EXPECT_TRUE(have_equal_blocks(load_or_build(mesh, folder.path())->tree(), built.tree()));
  EXPECT_EQ(contents_of(file), good);
}

TEST_F(IndexCache, AFileCutShortOrGrownIsNotLoaded) {
  ASSERT_TRUE(save_index(built, file));
  const std::string good = contents_of(file);
  for (std::size_t length = 0; length < good.size(); length += length < 120 ? 1 : 2977) {
    std::ofstream(file, std::ios::binary) << good.substr(0, length);
    ASSERT_EQ(load_index(mesh, file), nullptr) << length;
  }
  std::ofstream(file, std::ios::binary) << good << 'x';
  EXPECT_EQ(load_index(mesh, file), nullptr);
}

TEST_F(IndexCache, AFileWithAnyBitChangedIsNotLoaded) {
  ASSERT_TRUE(save_index(built, file));
  const std::string good = contents_of(file);
  std::mt19937 random(1);
  for (int i = 0; i < 400; ++i) {
    // Changes bits all over the header, and some in the rest.
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
    const auto moved = mesh_of(std::move(other));
    EXPECT_NE(index_cache_file(*moved, folder.path()), file);
    EXPECT_EQ(load_index(moved, file), nullptr);
  }
}

TEST_F(IndexCache, WhereNothingCanBeWrittenTheIndexIsBuiltAllTheSame) {
  folder.write("occupied", "a file where the folder should be");
  EXPECT_TRUE(
      have_equal_blocks(load_or_build(mesh, folder.path() / "occupied")->tree(), built.tree()));
  fs::create_directories(file / "occupied");
  EXPECT_TRUE(have_equal_blocks(load_or_build(mesh, folder.path())->tree(), built.tree()));
  EXPECT_FALSE(save_index(built, folder.path() / "no" / "such.wide_bvh"));
  // The failed attempts leave no files.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2);
}

TEST_F(IndexCache, ManyMayReadAndWriteAtOnce) {
  std::vector<int> good(4, 0);
  std::vector<std::thread> threads;
  for (int& count : good) {
    threads.emplace_back([&] {
      for (int i = 0; i < 30; ++i) {
        if (i % 5 == 4) fs::remove(file);
        count +=
            have_equal_blocks(load_or_build(mesh, folder.path())->tree(), built.tree()) ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int count : good) EXPECT_EQ(count, 30);
}

// A made-up order of triangles, with valid digests.

class MadeUpOrder : public IndexCache {
 protected:
  std::vector<TriangleId> order = built.order();

  bool is_accepted() const {
    return error_of([&] { WideBvh(mesh, order); }) == "no error";
  }
};

TEST_F(MadeUpOrder, OfTheBuildGivesTheSameTreeWhateverTheNumberOfThreads) {
  for (const unsigned threads : {0u, 1u, 3u}) {
    EXPECT_TRUE(have_equal_blocks(WideBvh(mesh, order, threads).tree(), built.tree()));
  }
}

TEST_F(MadeUpOrder, ThatDoesNotNameEachTriangleOnceIsRefused) {
  const std::vector<TriangleId> good = order;
  for (const TriangleId wrong : {good[0], TriangleId{1152}, TriangleId{1} << 31, no_triangle}) {
    for (const std::size_t place : {std::size_t{1}, std::size_t{700}, good.size() - 1}) {
      order = good;
      order[place] = wrong;
      EXPECT_FALSE(is_accepted()) << wrong << " at " << place;
    }
  }
  order = good;
  order.pop_back();
  EXPECT_FALSE(is_accepted());
  order = good;
  order.push_back(good[0]);
  EXPECT_FALSE(is_accepted());
  order = {};
  EXPECT_FALSE(is_accepted());
  order = good;
  EXPECT_TRUE(is_accepted());
}

TEST_F(MadeUpOrder, ThatIsAcceptedFindsWhatBruteForceFinds) {
  // Any order gives right answers, if perhaps a worse tree.
  std::mt19937 random(2);
  const std::vector<Vec3> points = probing_points(*mesh, 1);
  for (int i = 0; i < 300; ++i) {
    for (int swaps = 0; swaps < 1 + i * 4; ++swaps) {
      std::swap(order[random() % order.size()], order[random() % order.size()]);
    }
    const WideBvh index(mesh, order);
    const Vec3& point = points[random() % points.size()];
    const std::vector<double> all = distances(*mesh, point);
    const double radius = *std::min_element(all.begin(), all.end()) + 0.5;
    TriangleBuffer found(mesh->triangle_count());
    index.collect({point, radius}, found);
    const auto touching =
        std::count_if(all.begin(), all.end(), [&](double d) { return d <= radius; });
    ASSERT_EQ(static_cast<std::ptrdiff_t>(found.size()), touching);
  }
}

}  // namespace
}  // namespace keepout
