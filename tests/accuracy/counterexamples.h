// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <ostream>
#include <string_view>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// A mesh and a motion on which some reading of the paper's Algorithm 1 fails.
struct Counterexample {
  std::string_view name;
  Surface surface;
  Vec3 tip;
  Vec3 desired;
  double radius;
};

/// What a test prints of one.
inline void PrintTo(const Counterexample& example, std::ostream* out) { *out << example.name; }

inline std::vector<Counterexample> counterexamples() {
  const Surface saddle{
      {Vec3(0, 0, 0), Vec3(2, 3, 1), Vec3(-3, -7, -2), Vec3(-10, 2, 4), Vec3(-4, -3, -1)},
      {{0, 1, 3}, {2, 0, 3}, {1, 0, 4}, {0, 2, 4}}};
  Surface larger_saddle = saddle;
  larger_saddle.vertices[1] = Vec3(6, 9, 3);
  return {
      {"CE1_coplanar_tie",
       {{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}, {{0, 1, 2}, {0, 2, 3}}},
       {0.5, 0.5, 0.1},
       {0, 0, -0.2},
       1.0},
      {"CE2_boundary",
       {{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}}},
       {0.3, -0.01, 0.05},
       {0, 0.05, -0.15},
       1.0},
      {"CE3_obtuse_valley",
       {{Vec3(0, -2, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), Vec3(-2, 0, 2)}, {{0, 1, 2}, {0, 2, 3}}},
       {0.2, 0, 0.1},
       {-1, 0, -0.05},
       1.1},
      {"CE4_on_a_ridge",
       {{Vec3(0, -2, 0), Vec3(2, 0, -1), Vec3(0, 2, 0), Vec3(-2, 0, -1)}, {{0, 1, 2}, {0, 2, 3}}},
       {0, 0, 0},
       {0, 0, -0.5},
       1.0},
      {"CE5_closed_octahedron",
       {{Vec3(4, 1, 0), Vec3(-3, 2, -2), Vec3(6, 4, 1), Vec3(1, -6, -2), Vec3(-6, 3, 4),
         Vec3(0, -2, -1)},
        {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}},
       {3.5, -0.5, -0.75},
       {0.6382, 1.7526, 0.8442},
       2.1},
      {"CE6b_saddle", saddle, {-0.5, -1.5, -0.75}, {0.64, 1.75, 0.84}, 2.1},
      {"CE6c_larger_saddle", larger_saddle, {-0.5, -1.5, -0.75}, {3.3, 7.4, 3.6}, 8.9},
      {"CE7_lock_up",
       {{Vec3(2, 2, 0), Vec3(-4, -1, -3), Vec3(0, -2, -2), Vec3(3, 2, 2), Vec3(3, -1, -4)},
        {{1, 2, 3}, {2, 0, 3}, {2, 1, 4}, {0, 2, 4}}},
       {-0.0001, -2.0008, -2.0005},
       {-0.65, 0.6, 0.45},
       1.0},
      {"CE8_vertex_branch",
       {{Vec3(0, 0, 0), Vec3(3, 0, 4), Vec3(0, 2, 4), Vec3(-4, 0, -1), Vec3(0, -2, -2)},
        {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}}},
       {-2.5, -1, 1},
       {2.7, 1, -1},
       3.1},
  };
}

}  // namespace keepout
