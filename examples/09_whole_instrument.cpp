// SPDX-License-Identifier: BSD-3-Clause
// A whole instrument of six joints: shaft, wrist and jaws are kept out, on the curves that the
// joints really make. A planner also queries how much of its own motion is clear.
#include <algorithm>
#include <array>
#include <cstdio>
#include <numbers>
#include <vector>

#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/keepout.h"
#include "keepout/robot/denavit_hartenberg.h"

namespace {

using keepout::DenavitHartenberg;
using keepout::LinkPoint;
using keepout::Vec3;

/// Returns the patient-side manipulator of the da Vinci Research Kit with a large needle driver,
/// with its port at `port`. Table and position limits are those of the kit; velocity limits are
/// similar to those that users set.
keepout::Instrument patient_side_manipulator(const Vec3& port) {
  constexpr double right = std::numbers::pi / 2.0;
  const std::array<DenavitHartenberg, 6> table{{
      {"yaw", keepout::JointKind::revolute, 0, right, 0, right, {-1.588, 1.588, 1.0}},
      {"pitch", keepout::JointKind::revolute, 0, -right, 0, -right, {-0.925, 0.925, 1.0}},
      {"insertion", keepout::JointKind::prismatic, 0, right, -431.8, 0, {0.0, 240.0, 200.0}},
      {"roll", keepout::JointKind::revolute, 0, 0, 416.2, 0, {-4.537, 4.537, 8.0}},
      {"wrist_pitch", keepout::JointKind::revolute, 0, -right, 0, -right, {-1.396, 1.396, 8.0}},
      {"wrist_yaw", keepout::JointKind::revolute, 9.1, -right, 0, -right, {-1.396, 1.396, 8.0}},
  }};
  const auto [joints, end] = keepout::joints_of(table, keepout::DhConvention::modified);
  // Link 0 has its origin in the port. The jaws are along y of the last link.
  const LinkPoint at_port{0, Vec3::Zero()}, wrist{4, Vec3::Zero()}, yaw_axis{5, Vec3(9.1, 0, 0)};
  const LinkPoint tip{6, Vec3(0, 10.2, 0)};
  return {keepout::Chain(joints, {.position = port}, {.position = tip.position}),
          {{.name = "shaft", .points = {at_port, wrist}, .radius = 4.5},
           {.name = "wrist", .points = {wrist, yaw_axis}, .radius = 3.0},
           {.name = "jaws", .points = {yaw_axis, tip}, .radius = 1.0}}};
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\n", argv[0]);
    return 2;
  }
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  const keepout::Box& box = mesh->bounds();
  // The port is 120 mm above the mesh. The tip is straight below it, 10 mm above the mesh.
  const Vec3 port(box.center().x(), box.center().y(), box.high.z() + 120.0);
  constexpr double margin = 0.5, period = 0.001;  // [mm], [s]
  const keepout::Instrument instrument = patient_side_manipulator(port);
  auto guard = keepout::make_instrument_constraint(
      mesh, instrument,
      {.options = {.margin = margin,
                   .band = keepout::recommended_band(instrument, period),
                   .period = period}});

  // With the joints at 0 the tip is 3.7 mm beyond the port; insertion moves it down.
  keepout::ChainState chain;
  std::vector<double> q(6, 0.0);
  instrument.chain().forward_kinematics(q, chain);
  q[2] = chain.flange().position.z() - (box.high.z() + 10.0);

  // A planner's query: 20 mm straight down, through the surface. Nothing moves.
  const std::vector<double> down{0, 0, 20.0, 0, 0, 0};
  const keepout::MotionProof proof = guard.prove(q, down);
  std::printf("clear are %.4f mm of 20 (%s)\n", 20.0 * proof.fraction, name(proof.status).data());

  // Teleoperation: the operator presses down, and moves aside and back.
  int held = 0, stopped = 0, nearest_body = -1;
  double nearest = 10.0;
  constexpr int cycles = 3000;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const double sideways = cycle % 1000 < 500 ? 0.05 : -0.05;
    const keepout::InstrumentStep step = guard.step(q, {.linear = {sideways, 0.0, -0.05}});
    if (!step.ok() && stopped++ == 0) std::printf("%s\n", step.reason().data());
    held += step.status == keepout::Status::limited;
    if (step.distance.value_or(nearest) < nearest) {
      nearest = *step.distance;
      nearest_body = step.nearest;
    }
    for (std::size_t k = 0; k < step.increment.size(); ++k) q[k] += step.increment[k];
  }
  instrument.chain().forward_kinematics(q, chain);
  const Vec3 tip = chain.flange().position;
  std::printf("held back in %d of %d cycles, stopped in %d, nearest %.6f mm of %.1f: the %s\n",
              held, cycles, stopped, nearest, margin,
              nearest_body < 0 ? "none" : instrument.bodies()[nearest_body].name.c_str());
  std::printf("ends at %.6f %.6f %.6f\n", tip.x(), tip.y(), tip.z());
  return 0;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
