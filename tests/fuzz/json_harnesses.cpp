// SPDX-License-Identifier: BSD-3-Clause
// Readers of robots, records and registrations.
#include <cmath>
#include <sstream>

#include "fuzz/harness.h"
#include "record/report.h"
#include "settings.h"
#include "shared/progress.h"
#include "verify/result.h"
#if KEEPOUT_HAS_URDF
#include "bodies_file.h"
#include "keepout/urdf/read_chain.h"
#include "keepout/urdf/read_robot.h"
#endif

namespace keepout::fuzz {
namespace {

#if KEEPOUT_HAS_URDF
void require_finite(const Chain& chain) {
  ChainState state;
  const std::vector<double> zeros(static_cast<std::size_t>(chain.size()), 0.0);
  chain.forward_kinematics(zeros, state);
  for (int link = 0; link <= chain.size(); ++link) {
    const Pose pose = state.link(link);
    require(pose.position.allFinite() && pose.rotation.allFinite(), "links are finite");
  }
}

void read_urdf(Bytes bytes) {
  ignore_errors([&] {
    const UrdfChain read = parse_chain(text_of(bytes), "robot.urdf", "", "");
    require(read.links.size() == read.joints.size() + 1, "each joint moves a link");
    require_finite(Chain(read.joints, {}, read.flange));
  });
  ignore_errors([&] {
    const UrdfRobot robot = read_robot(scratch_file("robot.urdf", bytes));
    require_finite(robot.instrument.chain());
    for (const Body& body : robot.instrument.bodies()) {
      require(std::isfinite(body.radius) && body.radius >= 0.0, "radii are finite");
    }
  });
}

constexpr std::string_view three_links =
    "<robot name='r'><link name='base'/><link name='arm'/><link name='tip'/>"
    "<joint name='a' type='revolute'><parent link='base'/><child link='arm'/><axis xyz='0 0 1'/>"
    "<limit lower='-1' upper='1' velocity='1' effort='1'/></joint>"
    "<joint name='b' type='prismatic'><parent link='arm'/><child link='tip'/>"
    "<origin xyz='0.1 0 0'/><axis xyz='1 0 0'/>"
    "<limit lower='0' upper='0.2' velocity='1' effort='1'/></joint></robot>";

void read_bodies(Bytes bytes) {
  ignore_errors([&] { parse_bodies(text_of(bytes)); });
  static const auto urdf =
      scratch_file("three_links.urdf",
                   {reinterpret_cast<const std::uint8_t*>(three_links.data()), three_links.size()});
  ignore_errors([&] {
    const UrdfRobot robot = read_robot(urdf, scratch_file("bodies.json", bytes));
    require_finite(robot.instrument.chain());
    require(!robot.instrument.bodies().empty(), "a robot has bodies");
  });
}
#endif

void read_record(Bytes bytes) {
  app::be_quiet();
  const auto file = scratch_file("record.json", bytes);
  ignore_errors([&] {
    std::ostringstream out;
    app::report({.record = file, .page = file.parent_path() / "page.html"}, out);
  });
  ignore_errors([&] { app::merged({file}, "keepout verify"); });
}

void read_registration(Bytes bytes) {
  constexpr std::string_view triangle = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  static const auto mesh = scratch_file(
      "mesh.off", {reinterpret_cast<const std::uint8_t*>(triangle.data()), triangle.size()});
  ignore_errors([&] {
    const crtk::Scene scene = crtk::load_scene(
        {.mesh = mesh.string(), .registration = scratch_file("registration.json", bytes)});
    const Pose pose = scene.registration.mesh_in_robot();
    require(is_valid(pose), "a registration is a valid pose");
  });
}

}  // namespace

std::span<const Harness> json_harnesses() noexcept {
  static constexpr Harness all[] = {
#if KEEPOUT_HAS_URDF
    {"urdf", "adapters/urdf/src", read_urdf},
    {"bodies", "adapters/urdf/src/bodies_file.cpp adapters/urdf/src/read_robot.cpp", read_bodies},
#endif
    {"record",
     "apps/keepout/record/report.cpp apps/keepout/record/record.cpp "
     "apps/keepout/record/plain_page.cpp apps/keepout/record/flat_rows.cpp "
     "apps/keepout/verify/merge.cpp",
     read_record},
    {"registration", "apps/crtk_node/settings.cpp control/src/registration.cpp", read_registration},
  };
  return all;
}

}  // namespace keepout::fuzz
