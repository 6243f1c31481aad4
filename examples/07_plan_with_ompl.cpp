// SPDX-License-Identifier: BSD-3-Clause
// An OMPL planner near a mesh: with two lines, every motion of its tree is proved.
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <cstdio>

#include "keepout/adapters/index_registry.h"
#include "keepout/keepout.h"
#include "keepout/ompl/planning.h"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\n", argv[0]);
    return 2;
  }
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  const keepout::Box& box = mesh->bounds();

  // The space of the tip, in the frame of the mesh, with some free space around it.
  auto space = std::make_shared<ompl::base::RealVectorStateSpace>(3);
  ompl::base::RealVectorBounds bounds(3);
  for (unsigned int i = 0; i < 3; ++i) {
    bounds.setLow(i, box.low[i] - 20.0);
    bounds.setHigh(i, box.high[i] + 20.0);
  }
  space->setBounds(bounds);
  ompl::msg::setLogLevel(ompl::msg::LOG_WARN);
  ompl::geometric::SimpleSetup setup(space);

  // Makes one guard for each thread when it is needed; all use one index.
  const std::shared_ptr<const keepout::SpatialIndex> index = keepout::make_index("wide_bvh", mesh);
  const auto guards = std::make_shared<keepout::GuardPool>([mesh, index] {
    return keepout::make_motion_constraint(mesh, index,
                                           {.options = {.tool_radius = 0.3, .margin = 0.2}});
  });
  keepout::set_certified_checkers(setup.getSpaceInformation(), guards);

  // From above to below.
  ompl::base::ScopedState<> start(space), goal(space);
  start = std::vector<double>{box.center().x(), box.center().y(), box.high.z() + 10.0};
  goal = std::vector<double>{box.center().x(), box.center().y(), box.low.z() - 10.0};
  setup.setStartAndGoalStates(start, goal);

  // Any planner is suitable; keepout::make_sliding_connect makes one that slides along the mesh.
  setup.setPlanner(std::make_shared<ompl::geometric::RRTConnect>(setup.getSpaceInformation()));
  if (setup.solve(5.0) != ompl::base::PlannerStatus::EXACT_SOLUTION) {
    std::printf("no path was found in 5 s\n");
    return 1;
  }
  std::printf("a path of %zu proven motions, %.1f long\n",
              setup.getSolutionPath().getStateCount() - 1, setup.getSolutionPath().length());
  return 0;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
