// SPDX-License-Identifier: BSD-3-Clause
// An OMPL planner in the joint space of a whole instrument: shaft and tip are proved clear on the
// motions that the joints really make.
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <cmath>
#include <cstdio>

#include "keepout/adapters/index_registry.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/keepout.h"
#include "keepout/ompl/joint_planning.h"

namespace {

using keepout::Vec3;

/// Returns a shaft that turns about its port in two directions, and slides through it: yaw, pitch
/// and insertion. With all joints at 0 it points down, and its tip is in the port.
keepout::Instrument shaft_through(const Vec3& port, double longest) {
  const keepout::JointLimits turn{.lower = -1.2, .upper = 1.2};
  const keepout::Chain chain({{.name = "yaw", .axis = Vec3::UnitY(), .limits = turn},
                              {.name = "pitch", .axis = Vec3::UnitX(), .limits = turn},
                              {.name = "insertion",
                               .kind = keepout::JointKind::prismatic,
                               .axis = -Vec3::UnitZ(),
                               .limits = {.lower = 0.0, .upper = longest}}},
                             {.position = port});
  return {chain,
          {{.name = "shaft", .points = {{0, Vec3::Zero()}, {3, Vec3::Zero()}}, .radius = 4.0}}};
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\n", argv[0]);
    return 2;
  }
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  const keepout::Box& box = mesh->bounds();
  const double above = box.size().z();
  const Vec3 port(box.center().x(), box.center().y(), box.high.z() + above);
  const keepout::Instrument instrument = shaft_through(port, 3.0 * above);

  ompl::msg::setLogLevel(ompl::msg::LOG_WARN);
  ompl::geometric::SimpleSetup setup(keepout::make_joint_space(instrument));
  const std::shared_ptr<const keepout::SpatialIndex> index = keepout::make_index("wide_bvh", mesh);
  const auto guards = std::make_shared<keepout::InstrumentPool>([=] {
    return keepout::make_instrument_constraint(mesh, index, instrument,
                                               {.options = {.margin = 0.5}});
  });
  keepout::set_certified_checkers(setup.getSpaceInformation(), guards);

  // From one side of the mesh to the other; a straight motion would sweep the shaft through the
  // mesh.
  const double aside = std::atan2(0.5 * box.size().x() + 10.0, above);
  ompl::base::ScopedState<> start(setup.getStateSpace()), goal(setup.getStateSpace());
  start = std::vector<double>{-aside, 0.0, 1.5 * above};
  goal = std::vector<double>{aside, 0.0, 1.5 * above};
  setup.setStartAndGoalStates(start, goal);
  setup.setPlanner(std::make_shared<ompl::geometric::RRTConnect>(setup.getSpaceInformation()));
  if (setup.solve(5.0) != ompl::base::PlannerStatus::EXACT_SOLUTION) {
    std::printf("no path was found in 5 s\n");
    return 1;
  }
  std::printf("a path of %zu proven joint motions, %.1f long\n",
              setup.getSolutionPath().getStateCount() - 1, setup.getSolutionPath().length());
  return 0;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
