#include <cstdio>
#include <vector>

#include "keepout/keepout.h"

int main(int argc, char** argv) try {
  using keepout::Vec3;
  if (argc != 2) throw keepout::Error("usage: instrument MESH");
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  const std::vector<keepout::Joint> joints{
      {.name = "tilt", .axis = Vec3::UnitY(), .limits = {-1.0, 1.0, 1.0}},
      {.name = "slide",
       .kind = keepout::JointKind::prismatic,
       .axis = -Vec3::UnitZ(),
       .limits = {0.0, 100.0, 100.0}}};
  const Vec3 tip(0, 0, -10);
  const keepout::Pose port{.position = {0, 0, mesh->bounds().high.z() + 40.0}};
  const keepout::Instrument instrument(
      keepout::Chain(joints, port, {.position = tip}),
      {{.name = "shaft", .points = {{0, Vec3::Zero()}, {2, tip}}, .radius = 2.0}});
  auto guard = keepout::make_instrument_constraint(mesh, instrument, {.options = {.margin = 0.5}});
  std::vector<double> q{0.0, 0.0};
  for (int cycle = 0; cycle < 1000; ++cycle) {
    const keepout::InstrumentStep step = guard.step(q, {.linear = {0.01, 0.0, -0.05}});
    for (std::size_t k = 0; k < step.increment.size(); ++k) q[k] += step.increment[k];
  }
  std::printf("%.3f rad, %.3f mm\n", q[0], q[1]);
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
