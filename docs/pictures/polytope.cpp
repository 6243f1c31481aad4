// SPDX-License-Identifier: BSD-3-Clause
// For docs/pictures/draw: the planes of a free polytope, 'nx ny nz offset' a line.
//   draw_polytope MESH TOOL_RADIUS MARGIN RADIUS X Y Z
#include <cstdio>
#include <cstdlib>

#include "keepout/keepout.h"

int main(int argc, char** argv) try {
  if (argc != 8) {
    std::fprintf(stderr, "usage: %s MESH TOOL_RADIUS MARGIN RADIUS X Y Z\n", argv[0]);
    return 2;
  }
  const auto number = [&](int i) { return std::strtod(argv[i], nullptr); };
  auto guard =
      keepout::make_motion_constraint(keepout::load_mesh(argv[1]).mesh,
                                      {.options = {.tool_radius = number(2), .margin = number(3)}});
  const keepout::Polytope free = guard.free_polytope({number(5), number(6), number(7)}, number(4));
  if (!free.ok()) {
    std::fprintf(stderr, "%s\n", free.reason().data());
    return 1;
  }
  for (const keepout::HalfSpace& plane : free.planes) {
    std::printf("%.17g %.17g %.17g %.17g\n", plane.normal.x(), plane.normal.y(), plane.normal.z(),
                plane.offset);
  }
  return 0;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
