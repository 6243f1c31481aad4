// SPDX-License-Identifier: BSD-3-Clause
// The minimal program: a mesh, a motion constraint, and one step in each control cycle.
#include <cstdio>

#include "keepout/keepout.h"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\n", argv[0]);
    return 2;
  }
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  auto guard =
      keepout::make_motion_constraint(mesh, {.index = "wide_bvh",
                                             .activation = "certified",
                                             .options = {.tool_radius = 0.3, .margin = 0.2}});

  // The commanded motion starts above the mesh and goes straight down through it.
  const keepout::Box& box = mesh->bounds();
  keepout::Vec3 tip(box.center().x(), box.center().y(), box.high.z() + 5.0);
  const keepout::Vec3 goal(tip.x(), tip.y(), box.low.z());
  int held = 0;
  for (int cycle = 0; cycle < 2000; ++cycle) {
    const keepout::Step step = guard.step({.tip = tip, .desired = 0.2 * (goal - tip).normalized()});
    if (!step.ok()) std::printf("cycle %d: %s\n", cycle, step.reason().data());
    held += step.status != keepout::Status::free;
    tip += step.motion;  // zero unless ok
  }
  std::printf("held back in %d of 2000 cycles, ends at %.6f %.6f %.6f\n", held, tip.x(), tip.y(),
              tip.z());
  return 0;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
