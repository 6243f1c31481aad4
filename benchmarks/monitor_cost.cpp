// SPDX-License-Identifier: BSD-3-Clause
//
// keepout_monitor_cost MESH.stl [MILLIONS]: the time of steps without and with a monitor, and the
// number of motions that the monitor did not confirm. Loops push a tip and an instrument onto the
// mesh, in mm; MILLIONS of tip steps (1), and a tenth as many cycles of the instrument.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/random.h"
#include "keepout/fixtures/robots.h"
#include "keepout/mesh/load_mesh.h"

namespace {

using namespace keepout;

/// The times of steps, and the steps that were not confirmed.
class Times {
 public:
  template <class Step>
  auto of(const Step& step) {
    const auto start = std::chrono::steady_clock::now();
    const auto result = step();
    times_.push_back(
        std::chrono::duration<float, std::micro>(std::chrono::steady_clock::now() - start).count());
    unconfirmed_ += result.status == Status::unconfirmed ? 1 : 0;
    return result;
  }
  void print(const char* what) {
    std::ranges::sort(times_);
    const auto at = [&](double share) {
      return times_[static_cast<std::size_t>(share * static_cast<double>(times_.size() - 1))];
    };
    std::printf("| %s | %zu | %.2f | %.2f | %.2f | %.1f | %zu |\n", what, times_.size(), at(0.5),
                at(0.99), at(0.999), at(1.0), unconfirmed_);
  }

 private:
  std::vector<float> times_;
  std::size_t unconfirmed_ = 0;
};

Vec3 top_of(const Mesh& mesh) {
  return *std::ranges::max_element(mesh.vertices(), {}, [](const Vec3& v) { return v.z(); });
}

Times tip_loop(const std::shared_ptr<const Mesh>& mesh, bool monitor, std::size_t steps) {
  MotionConstraint guard = make_motion_constraint(
      mesh, {.options = {.radius = 5.0, .tool_radius = 0.5, .margin = 0.2}, .monitor = monitor});
  Random random(1);
  Times times;
  Vec3 tip = Vec3::Zero(), aim = Vec3::Zero();
  for (std::size_t i = 0; i < steps; ++i) {
    if (i % 20'000 == 0) tip = top_of(*mesh) + Vec3(0.0, 0.0, 3.0);
    if (i % 500 == 0) aim = mesh->vertices()[random.below(mesh->vertices().size())];
    const double pace = std::pow(10.0, random.uniform(-3.0, 0.0));
    const Vec3 desired = pace * (aim - tip).normalized() + 0.3 * pace * random.direction();
    tip += times.of([&] { return guard.step({.tip = tip, .desired = desired}); }).motion;
  }
  return times;
}

Times instrument_loop(const std::shared_ptr<const Mesh>& mesh, bool monitor, std::size_t cycles) {
  const Instrument robot = psm({top_of(*mesh) + Vec3(0.3, 0.2, 120.0)});
  InstrumentConstraint guard =
      make_instrument_constraint(mesh, robot, {.monitor = monitor, .options = {.period = 0.1}});
  Random random(1);
  Times times;
  std::vector<double> q;
  Vec3 way = Vec3::Zero();
  for (std::size_t i = 0; i < cycles; ++i) {
    if (i % 5'000 == 0) q = {0.0, 0.0, 100.0, 0.0, 0.0, 0.0};
    if (i % 5'000 == 0) guard.forget();
    if (i % 200 == 0) way = random.direction() - 0.7 * Vec3::UnitZ();
    const double pace = std::pow(10.0, random.uniform(-2.0, 0.0));
    const InstrumentStep step = times.of([&] {
      return guard.step(q, {.linear = pace * (way + 0.3 * random.direction()),
                            .angular = 0.02 * pace * random.direction()});
    });
    for (std::size_t k = 0; step.ok() && k < q.size(); ++k) q[k] += step.increment[k];
  }
  return times;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("give a mesh file, and millions of steps\n", stderr);
    return 2;
  }
  const auto mesh = load_mesh(argv[1]).mesh;
  const double millions = argc > 2 ? std::atof(argv[2]) : 1.0;
  const auto steps = static_cast<std::size_t>(1e6 * millions);
  std::puts("| steps | number | median, µs | 99 % | 99.9 % | longest | unconfirmed |");
  std::puts("|---|--:|--:|--:|--:|--:|--:|");
  tip_loop(mesh, false, steps).print("tip");
  tip_loop(mesh, true, steps).print("tip, monitored");
  instrument_loop(mesh, false, steps / 10).print("instrument");
  instrument_loop(mesh, true, steps / 10).print("instrument, monitored");
}
