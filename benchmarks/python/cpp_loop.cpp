// SPDX-License-Identifier: BSD-3-Clause
// The C++ loop that the Python module is compared with, bitwise and in time: steps over poses from
// a file, on one thread.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "keepout/keepout.h"
#include "keepout/simd_target.h"

namespace {

/// The layout of the file.
struct Pose {
  double tip[3];
  double desired[3];
};
struct Answer {
  double motion[3];
  double status, planes;
};

std::vector<Pose> read(const char* path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw keepout::Error(std::string(path) + ": cannot be read");
  std::vector<Pose> poses(static_cast<std::size_t>(file.tellg()) / sizeof(Pose));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(poses.data()),
            static_cast<std::streamsize>(poses.size() * sizeof(Pose)));
  return poses;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 6) {
    std::fprintf(stderr, "usage: %s MESH POSES ANSWERS anew|as_is|remembering PASSES\n", argv[0]);
    return 2;
  }
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  const std::string memory = argv[4];
  const bool anew = memory == "anew";
  auto constraint = keepout::make_motion_constraint(
      mesh, {.options = {.tool_radius = 0.3, .margin = 0.2},
             .inside = memory == "as_is" ? keepout::Inside::taken_as_is : keepout::Inside::escape});
  const std::vector<Pose> poses = read(argv[2]);
  std::vector<Answer> answers(poses.size());

  double best = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < std::atoi(argv[5]); ++pass) {
    constraint.forget();
    const std::clock_t start = std::clock();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (anew) constraint.forget();
      const Pose& pose = poses[i];
      const keepout::Step step =
          constraint.step({.tip = {pose.tip[0], pose.tip[1], pose.tip[2]},
                           .desired = {pose.desired[0], pose.desired[1], pose.desired[2]}});
      answers[i] = {{step.motion.x(), step.motion.y(), step.motion.z()},
                    static_cast<double>(step.status),
                    static_cast<double>(step.planes.size())};
    }
    // Processor time, which other load on the machine affects less.
    const double taken = 1e9 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    best = std::min(best, taken / static_cast<double>(poses.size()));
  }
  std::ofstream file(argv[3], std::ios::binary);
  file.write(reinterpret_cast<const char*>(answers.data()),
             static_cast<std::streamsize>(answers.size() * sizeof(Answer)));
  std::printf("%.1f GCC %s, %s\n", best, __VERSION__,
              std::string(keepout::simd_target()).c_str());  // [ns a step]
  return file ? 0 : 1;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
