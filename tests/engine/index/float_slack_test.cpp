// SPDX-License-Identifier: BSD-3-Clause
// Compares the filters in single precision with the same claims in double. Each test is about one
// slack for rounding, in a case where no other slack covers the rounding.

#include <Eigen/Geometry>
#include <set>

#include "engine/index/exact_index.h"
#include "index/tree_parts/ball_screen.h"
#include "index/wide_bvh/traversal/filters.h"
#include "index/wide_bvh/traversal/traversal_cache.h"
#include "meshes.h"

namespace keepout {
namespace {

/// Returns sixteen triangles, `size` large, which fit in one leaf. All coordinates are floats.
std::shared_ptr<const Mesh> one_leaf(double size, Random& random) {
  Surface surface;
  for (VertexId t = 0; t < LeafBlock::lanes; ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      surface.vertices.emplace_back((size * random.direction()).cast<float>().cast<double>());
    }
    surface.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh_of(std::move(surface));
}

/// Returns the gap between triangle and tip along this normal, minus the margin.
double clear_in_double(const Vec3& n, const Triangle& triangle, const Vec3& tip, double margin) {
  double support = n.dot(triangle[0] - tip);
  for (const Vec3& corner : triangle) support = std::max(support, n.dot(corner - tip));
  return -support - margin;
}

Vec3 normal_of(const ProofBlock& proofs, std::size_t lane) {
  return Vec3(proofs.n[0][lane], proofs.n[1][lane], proofs.n[2][lane]).normalized();
}

// In the first case the triangles are far larger than margin and motion. In the second the motion
// is far longer than margin and triangles.
TEST(FloatSlack, NoProofOfALeafClaimsMoreThanItsPlaneDoes) {
  Random random(1);
  int clear_of_a_motion = 0;
  for (const double size : {100.0, 1.0}) {
    for (int trial = 0; trial < test::trials(300); ++trial) {
      const double margin = 0.01;
      const double longest = size == 1.0 ? 1e3 : 0.01;
      const auto mesh = one_leaf(size, random);
      const WideBvh index(mesh);
      const Vec3 tip = random.uniform(0.0, 2.0) * size * random.direction();
      const FloatLevels levels = float_levels(margin, longest, tip, index.tree().frame().error);
      LeafFilter filter;
      fill_filter(index.tree().leaves()[0], float_tip(tip), levels, filter);
      for (int i = 0; i < 10; ++i) {
        // The motion ends slightly beyond the last point that the plane of one triangle allows.
        const std::size_t chosen = random.below(LeafBlock::lanes);
        const Vec3 n = normal_of(filter.at_tip, chosen);
        const double allowed = std::max(double{filter.at_tip.clear[chosen]}, 0.0);
        const double beyond = longest * std::pow(10.0, random.uniform(-9.0, -6.0));
        Vec3 motion = random.direction();
        motion -= n.dot(motion) * n;
        motion *= 0.9 * longest / motion.norm();
        motion -= std::min(allowed + beyond, 0.4 * longest) * n;
        const float in_float[3] = {static_cast<float>(motion.x()), static_cast<float>(motion.y()),
                                   static_cast<float>(motion.z())};
        Suspects suspects;
        const std::uint32_t begun = find_suspects(filter, in_float, 1.0f, suspects);
        for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
          const Triangle triangle = mesh->triangle(index.tree().leaves()[0].triangle(lane));
          const Vec3 its = normal_of(filter.at_tip, lane);
          const double clear = clear_in_double(its, triangle, tip, margin);
          ASSERT_LE(filter.at_tip.clear[lane], clear);
          if (((begun | suspects.mask) >> lane & 1u) != 0) continue;
          ASSERT_GE(clear + its.dot(motion), 0.0) << "at the end";
          ++clear_of_a_motion;
        }
      }
    }
  }
  EXPECT_GT(clear_of_a_motion, test::trials(10'000));
}

/// Returns the least distance of a motion from a shape up to a time. `distance(point)` is convex.
template <class Distance>
double least_distance(const Distance& distance, const Vec3& motion, double until) {
  double low = 0.0, high = until;
  for (int i = 0; i < 100; ++i) {
    const double third = (high - low) / 3.0;
    if (distance((low + third) * motion) < distance((high - third) * motion)) {
      high -= third;
    } else {
      low += third;
    }
  }
  return std::min({distance(Vec3(low * motion)), distance(Vec3::Zero()), distance(until * motion)});
}

// Motions past or to one of the triangles, and then others with the proofs of the first.
TEST(FloatSlack, NoSharpenedSuspectIsDelayedBeyondItsContact) {
  Random random(4);
  int removed = 0, delayed = 0;
  for (int trial = 0; trial < test::trials(400); ++trial) {
    const auto mesh = one_leaf(1.0, random);
    const WideBvh index(mesh);
    const LeafBlock& leaf = index.tree().leaves()[0];
    const double margin = 0.1;
    const Vec3 tip = random.uniform(0.5, 2.0) * random.direction();
    const FloatLevels levels = float_levels(margin, 4.0, tip, index.tree().frame().error);
    LeafFilter filter;
    fill_filter(leaf, float_tip(tip), levels, filter);
    for (int i = 0; i < 6; ++i) {
      const Vec3 near = mesh->triangle(leaf.triangle(random.below(LeafBlock::lanes)))[0] +
                        2.0 * margin * random.direction();
      const Vec3 motion =
          (random.uniform(0.5, 1.5) * (near - tip)).cast<float>().cast<double>().eval();
      const float in_float[3] = {static_cast<float>(motion.x()), static_cast<float>(motion.y()),
                                 static_cast<float>(motion.z())};
      const float latest = i % 2 == 0 ? 1.0f : static_cast<float>(random.uniform(0.1, 1.0));
      Suspects suspects;
      const std::uint32_t begun = find_suspects(filter, in_float, latest, suspects);
      for (int sharpening = 0; sharpening < 3; ++sharpening) {
        for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
          if ((begun >> lane & 1u) != 0) continue;
          const Triangle triangle = mesh->triangle(leaf.triangle(lane));
          const auto distance = [&](const Vec3& at) {
            return closest_point(triangle, tip + at).distance;
          };
          const bool is_suspect = (suspects.mask >> lane & 1u) != 0;
          const float until = is_suspect ? suspects.time[lane] : latest;
          ASSERT_GE(least_distance(distance, motion, std::min(double{until}, 1.0)), margin);
          ++(is_suspect ? delayed : removed);
          if (!is_suspect) continue;
          ASSERT_GE(suspects.time[lane], suspects.time[suspects.earliest]);
        }
        if (suspects.mask == 0) break;
        sharpen_suspects(leaf, float_tip(tip), in_float, levels, latest, 1 + sharpening, filter,
                         suspects);
      }
    }
  }
  EXPECT_GT(removed, test::trials(10'000));
  EXPECT_GT(delayed, test::trials(1'000));
}

// The nearest point of a cylinder is computed from its axis.
TEST(FloatSlack, NoCylinderIsPassedOverOrDelayedBeyondItsContact) {
  Random random(5);
  int removed = 0, delayed = 0;
  for (int trial = 0; trial < test::trials(2000); ++trial) {
    CylinderBlock cylinders{};
    for (std::size_t lane = 0; lane < CylinderBlock::lanes; ++lane) {
      const Vec3 axis = random.direction(), middle = random.direction();
      for (int i = 0; i < 3; ++i) {
        cylinders.axis[i][lane] = static_cast<float>(axis[i]);
        cylinders.middle[i][lane] = static_cast<float>(middle[i]);
      }
      cylinders.half_height[lane] = static_cast<float>(random.uniform(0.0, 0.3));
      cylinders.radius[lane] = static_cast<float>(random.uniform(0.01, 0.3));
    }
    const double margin = 0.1;
    const Vec3 tip = random.uniform(0.5, 2.0) * random.direction();
    const Vec3 motion =
        (random.uniform(0.3, 1.5) * random.direction() - tip).cast<float>().cast<double>();
    const float in_float[3] = {static_cast<float>(motion.x()), static_cast<float>(motion.y()),
                               static_cast<float>(motion.z())};
    BoxEntries entries{};
    entries.reached = 0xffff;
    enter_cylinders(cylinders, float_tip(tip), in_float, float_levels(margin, 4.0, tip, 0.0),
                    entries);
    for (std::size_t lane = 0; lane < CylinderBlock::lanes; ++lane) {
      Vec3 axis, middle;
      for (int i = 0; i < 3; ++i) {
        axis[i] = cylinders.axis[i][lane];
        middle[i] = cylinders.middle[i][lane];
      }
      axis.normalize();
      const auto distance = [&](const Vec3& at) {
        const Vec3 off = tip + at - middle;
        const double along = axis.dot(off);
        const double above = std::abs(along) - double{cylinders.half_height[lane]};
        const double beside = (off - along * axis).norm() - double{cylinders.radius[lane]};
        return std::hypot(std::max(above, 0.0), std::max(beside, 0.0));
      };
      const bool is_reached = (entries.reached >> lane & 1u) != 0;
      const double until = is_reached ? std::clamp(double{entries.time[lane]}, 0.0, 1.0) : 1.0;
      if (until == 0.0) continue;  // may begin too close
      ASSERT_GE(least_distance(distance, motion, until), margin);
      ++(is_reached ? delayed : removed);
    }
  }
  EXPECT_GT(removed, test::trials(5'000));
  EXPECT_GT(delayed, test::trials(1'000));
}

// The motions are far longer than the margin, and end just within the margin of a box.
TEST(FloatSlack, NoBoxIsPassedOverThatAMotionComesWithinTheMarginOf) {
  Random random(3);
  const auto point = [&] {
    return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  for (int trial = 0; trial < test::trials(5000); ++trial) {
    NodeBlock node{};
    for (std::size_t lane = 0; lane < NodeBlock::lanes; ++lane) {
      const Vec3 low = 10.0 * point();
      for (int axis = 0; axis < 3; ++axis) {
        node.low[axis][lane] = static_cast<float>(low[axis]);
        node.high[axis][lane] = node.low[axis][lane] + static_cast<float>(random.uniform(1, 5));
      }
    }
    const double margin = 1e-3;
    const std::size_t lane = random.below(NodeBlock::lanes);
    const auto across = static_cast<Eigen::Index>(random.below(3));
    Vec3 end;
    for (int axis = 0; axis < 3; ++axis) {
      end[axis] = random.uniform(node.low[axis][lane], node.high[axis][lane]);
    }
    end[across] = node.low[across][lane] - margin * (1.0 - 1e-9);
    Vec3 motion = 10.0 * point();
    motion[across] = std::abs(motion[across]);
    const Vec3 tip = end - motion;
    const float in_float[3] = {static_cast<float>(motion.x()), static_cast<float>(motion.y()),
                               static_cast<float>(motion.z())};
    BoxEntries entries;
    enter_boxes(node, float_tip(tip), in_float, float_levels(margin, motion.norm(), tip, 0.0),
                entries);
    ASSERT_TRUE((entries.reached >> lane & 1u) != 0) << trial;
    ASSERT_LE(entries.time[lane], 1.0f) << trial;
  }
}

// Each ball just touches one of the boxes.
TEST(FloatSlack, ATraversalCacheHasEveryBoxThatItsBallTouches) {
  const auto mesh = beginning_of("cortex", LeafBlock::lanes * NodeBlock::lanes);
  const WideBvh index(mesh);
  ASSERT_EQ(index.tree().nodes().size(), 1u);
  const NodeBlock& root = index.tree().nodes()[0];
  Random random(2);
  for (int trial = 0; trial < test::trials(2000); ++trial) {
    const Vec3 center = mesh->bounds().center() + mesh->bounds().size().norm() *
                                                      random.uniform(0.5, 2.0) * random.direction();
    const Vec3 from_origin = center - index.tree().frame().origin;
    std::vector<double> distances;
    for (std::size_t lane = 0; lane < NodeBlock::lanes; ++lane) {
      Vec3 off = Vec3::Zero();
      for (int axis = 0; axis < 3; ++axis) {
        off[axis] = std::max({root.low[axis][lane] - from_origin[axis],
                              from_origin[axis] - root.high[axis][lane], 0.0});
      }
      distances.push_back(off.norm());
    }
    const std::size_t touched = random.below(NodeBlock::lanes);
    const double radius = distances[touched] * (1.0 + 1e-10);
    TraversalCache cache;
    cache.cover(index.tree(), {center, radius});
    std::set<std::uint32_t> found;
    for (const NodeBlock& block : cache.blocks()) {
      found.insert(std::begin(block.child), std::end(block.child));
    }
    for (std::size_t lane = 0; lane < NodeBlock::lanes; ++lane) {
      ASSERT_TRUE(distances[lane] > radius || found.contains(root.child[lane])) << lane;
    }
  }
}

TEST(FloatSlack, ATraversalCacheCoversNoMoreThanItsBall) {
  const WideBvh index(mesh_of("cortex"));
  TraversalCache cache;
  cache.cover(index.tree(), {Vec3(0, 0, 50), 2.0});
  /// Returns the radius of the largest ball around a point that is covered.
  const auto covered_from = [&](const Vec3& center) {
    double in = 0.0, out = 100.0;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (in + out);
      (cache.covers({center, middle}) ? in : out) = middle;
    }
    return in;
  };
  const double radius = covered_from(Vec3(0, 0, 50));
  ASSERT_GE(radius, 2.0);
  for (const double share : {0.01, 0.3, 0.9}) {
    const double moved = share * radius;
    EXPECT_NEAR(covered_from(Vec3(0, moved, 50)), radius - moved, 1e-9);
  }
}

// Each cylinder must contain the child cylinders, not only the triangles. The child cylinders have
// their own slack, which would hide a missing slack here.
TEST(FloatSlack, CylindersOfNodesHoldTheCylindersBelow) {
  int held = 0;
  for (const char* name : {"cortex", "gear", "needles", "sphere"}) {
    const WideBvh index(mesh_of(name));
    const auto vector_of = [](const float(&from)[3][NodeBlock::lanes], std::size_t lane) {
      return Vec3(from[0][lane], from[1][lane], from[2][lane]);
    };
    for (std::size_t node = 0; node < index.tree().nodes().size(); ++node) {
      const CylinderBlock& above = index.tree().cylinders()[node];
      for (std::size_t lane = 0; lane < NodeBlock::lanes; ++lane) {
        const std::uint32_t child = index.tree().nodes()[node].child[lane];
        if (!index.tree().nodes()[node].is_used(lane) || (child & NodeBlock::leaf_bit) != 0)
          continue;
        const CylinderBlock& below = index.tree().cylinders()[child];
        const Vec3 axis = vector_of(above.axis, lane).normalized();
        for (std::size_t i = 0; i < NodeBlock::lanes && index.tree().nodes()[child].is_used(i);
             ++i) {
          const Vec3 way = vector_of(below.middle, i) - vector_of(above.middle, lane);
          const Vec3 its_axis = vector_of(below.axis, i).normalized();
          const double cosine = std::abs(its_axis.dot(axis));
          const double sine = its_axis.cross(axis).norm();
          const double height = std::abs(axis.dot(way)) + cosine * below.half_height[i];
          ASSERT_LE(height + sine * below.radius[i], above.half_height[lane]) << name << ' ' << i;
          // An upper bound of the distance from the axis to the farthest point of the child.
          const double away = (way - axis.dot(way) * axis).norm() + sine * below.half_height[i];
          ASSERT_LE(away + below.radius[i], above.radius[lane]) << name << ' ' << i;
          ++held;
        }
      }
    }
  }
  EXPECT_GT(held, 100);
}

TEST(FloatSlack, AMeshIsNotExactIfOneCoordinateOfItsLastVertexIsNoFloat) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const VertexId last : {3u, 4u, 7u, 8u, 9u}) {
      Surface surface{{}, {{0, 1, last}}};
      for (VertexId v = 0; v <= last; ++v) surface.vertices.emplace_back(v, 0.5 * v * v, 1.0);
      EXPECT_TRUE(WideBvh(mesh_of(surface)).tree().frame().is_exact());
      surface.vertices[last][axis] += 1e-9;
      EXPECT_FALSE(WideBvh(mesh_of(surface)).tree().frame().is_exact()) << axis;
    }
  }
}

const Box bounds{Vec3::Constant(-100.0), Vec3::Constant(100.0)};

// Some compilers used the unrounded number in place of the rounded one.
TEST(BallScreen, SplitsTheCentreIntoTwoFloatsThatMeanIt) {
  Random random(9);
  for (int i = 0; i < 1000; ++i) {
    const double size = std::pow(10.0, random.uniform(-6.0, 6.0));
    const Ball ball{size * random.direction(), 1.0};
    const BallScreen screen(ball, bounds, LeafFrame());
    ASSERT_TRUE(screen.fits);
    for (int axis = 0; axis < 3; ++axis) {
      const double x = ball.center[axis];
      EXPECT_LE(std::abs(double{screen.high_part[axis]} - x), 0x1p-24 * std::abs(x));
      EXPECT_LE(std::abs(double{screen.high_part[axis]} + double{screen.low_part[axis]} - x),
                0x1p-48 * std::abs(x) + 1e-44);
      EXPECT_LE(double{screen.below[axis]}, x);
      EXPECT_GE(double{screen.above[axis]}, x);
    }
  }
}

TEST(BallScreen, DrawsItsBoundsOnTheSafeSide) {
  Random random(10);
  for (int i = 0; i < 1000; ++i) {
    const double radius = std::pow(10.0, random.uniform(-12.0, 12.0));
    const BallScreen screen({100.0 * random.direction(), radius}, bounds, LeafFrame());
    EXPECT_LE(double{screen.inside2}, radius * radius);
    EXPECT_GE(double{screen.outside2}, radius * radius);
    EXPECT_LE(double{screen.box_inside2}, radius * radius);
    EXPECT_GE(double{screen.box_reach2}, radius * radius);
  }
}

TEST(BallScreen, IsSureOfNothingInABallWithoutASize) {
  const BallScreen screen({Vec3(1, 2, 3), 0.0}, bounds, LeafFrame());
  EXPECT_TRUE(screen.fits);
  EXPECT_LT(screen.inside2, 0.0f);
  EXPECT_LT(screen.box_inside2, 0.0f);
}

TEST(BallScreen, SaysWhereFloatsDoNotReach) {
  for (const Ball& ball :
       {Ball{Vec3(1e31, 0, 0), 1.0}, Ball{Vec3::Zero(), 1e19}, Ball{Vec3(0, test::nan, 0), 1.0},
        Ball{Vec3::Zero(), test::nan}, Ball{Vec3::Zero(), test::infinity}}) {
    EXPECT_FALSE(BallScreen(ball, bounds, LeafFrame()).fits);
  }
}

}  // namespace
}  // namespace keepout
