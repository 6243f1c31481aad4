#include <cstdio>

#include "keepout/keepout.h"

int main(int argc, char** argv) try {
  if (argc != 2) throw keepout::Error("usage: consumer MESH");
  auto guard = keepout::make_motion_constraint(keepout::load_mesh(argv[1]).mesh,
                                               {.options = {.margin = 0.5}});
  const keepout::Step step = guard.step({.tip = {0, 0, 12}, .desired = {1, 0, -4}});
  std::printf("%.6f %.6f: %s\n", step.motion.x(), step.motion.z(), step.reason().data());
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
