// SPDX-License-Identifier: BSD-3-Clause
// Runs a million cycles in contact: the losses within tolerance do not accumulate.

#include "accuracy/certified_loop.h"

namespace keepout::test {
namespace {

struct Scene {
  const char* name;
  const char* shape;
  Vec3 offset;  // of the world's origin [length]
  std::size_t cycles;
};

void PrintTo(const Scene& scene, std::ostream* out) { *out << scene.name; }

class CertifiedDrift : public testing::TestWithParam<Scene> {};

TEST_P(CertifiedDrift, TheMarginIsKeptInEveryCycleOfManyUnderPressure) {
  const Scene& scene = GetParam();
  constexpr double margin = 0.2;
  Loop loop(moved(make_shape(scene.shape), scene.offset),
            {.options = {.radius = 0.5, .margin = margin}, .capacity = {.planes = 200}});
  Random random(2);
  const std::vector<Vec3> starts = places(loop, 10, 1.1 * margin, random);
  ASSERT_EQ(starts.size(), 10u);
  std::size_t limited = 0, recovering = 0, other = 0;
  for (Vec3 tip : starts) {
    Vec3 drift = random.direction();
    Vec3 press = Vec3::Zero();
    for (std::size_t cycle = 0; cycle < scene.cycles / starts.size(); ++cycle) {
      if (cycle % 64 == 0) drift = random.direction();
      if (cycle % 8 == 0) press = loop.towards_surface(tip);
      const Vec3 desired = 0.1 * (press + 0.7 * drift + 0.3 * random.direction());
      const Step step = loop.step(tip, desired);
      ASSERT_TRUE(step.ok()) << step.reason() << ", cycle " << cycle;
      if (step.status == Status::limited) ++limited;
      if (step.status == Status::recovering) ++recovering;
      if (step.status == Status::truncated) ++other;
      const Vec3 next = tip + step.motion;
      // The oracle checks the whole segment, not only its end.
      const double tau = loop.tolerance(tip);
      const oracle::Finding way = loop.oracle().check(tip, next, margin - 3.0 * tau, 1.5 * margin);
      ASSERT_FALSE(way.crosses);
      ASSERT_FALSE(way.below) << "cycle " << cycle;
      tip = next;
    }
  }
  EXPECT_GT(limited, scene.cycles / 2) << "hardly in contact";
  EXPECT_EQ(recovering, 0u) << "closer than where recovery begins";
  EXPECT_EQ(other, 0u) << "truncated";
}

const Vec3 far(6e3, -7e3, 5e3);  // about 1e4 from the origin

INSTANTIATE_TEST_SUITE_P(Scenes, CertifiedDrift,
                         testing::Values(Scene{"cube", "cube", {0, 0, 0}, 200'000},
                                         Scene{"sphere", "sphere", {0, 0, 0}, 200'000},
                                         Scene{"valley", "cortex", {0, 0, 0}, 200'000},
                                         Scene{"cube_far", "cube", far, 150'000},
                                         Scene{"sphere_far", "sphere", far, 150'000},
                                         Scene{"valley_far", "cortex", far, 150'000},
                                         Scene{"cube_very_far", "far_cube", {0, 0, 0}, 150'000}),
                         by_name);

}  // namespace
}  // namespace keepout::test
