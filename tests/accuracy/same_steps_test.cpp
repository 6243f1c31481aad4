// SPDX-License-Identifier: BSD-3-Clause
//
// Steps are bitwise those of docs/records/steps.txt. The records of campaigns stay valid as long as
// the steps are the same. If you change a step on purpose, write the two numbers that the test
// prints to that file, and measure these records again (docs/records.md).

#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <type_traits>

#include "guards.h"
#include "keepout/fixtures/motions.h"

namespace keepout {
namespace {

/// The 64-bit FNV-1a hash of numbers, bit by bit.
class Fingerprint {
 public:
  void add(std::uint64_t number) noexcept {
    for (int byte = 0; byte < 8; ++byte) {
      hash_ = (hash_ ^ (number >> (8 * byte) & 255)) * 1099511628211u;
    }
  }
  void add(double number) noexcept { add(std::bit_cast<std::uint64_t>(number)); }
  template <class AnyStep>
  void add(const AnyStep& step) noexcept {
    add(static_cast<std::uint64_t>(step.status));
    if constexpr (std::is_same_v<AnyStep, Step>) {
      for (const double number : step.motion) add(number);
    }
    for (const double number : step.increment) add(number);
    for (const GuideState& guide : step.guides) add(guide.excess);
    add(step.distance.value_or(-1.0));
  }
  std::string text() const {
    std::array<char, 17> digits{};
    std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(hash_));
    return digits.data();
  }

 private:
  std::uint64_t hash_ = 14695981039346656037u;
};

constexpr std::array meshes{"cortex", "gear", "saddle_terrain", "star_bumps"};

/// Returns a line of docs/records/steps.txt without its name.
std::string recorded(const std::string& name) {
  std::ifstream file(KEEPOUT_STEPS);
  for (std::string of, text; file >> of >> text;) {
    if (of == name) return text;
  }
  return "";
}

TEST(SameSteps, OfTips) {
  Fingerprint fingerprint;
  int limited = 0;
  for (const char* name : meshes) {
    const auto mesh = mesh_of(make_shape(name));
    const auto index = std::make_shared<const WideBvh>(mesh);
    Random random(7);
    std::vector<Motion> motions = contact_motions(*mesh, *index, 2000, {}, random);
    for (const Motion& motion : unrelated_motions(*mesh, 1000, {.clearance = 0.3}, random)) {
      motions.push_back(motion);
    }
    const Vec3 center = mesh->bounds().center();
    const double size = mesh->bounds().size().norm();
    for (const double tool_radius : {0.0, 0.5}) {
      for (const int nodes : {0, 50}) {
        MotionConstraint guard = make_motion_constraint(
            mesh, index,
            {.options = {.tool_radius = tool_radius, .nodes = nodes}, .capacity = {.nodes = 64}});
        if (nodes > 0) guard.set_guides({Guide::point("ball", Region::ball(center, 0.45 * size))});
        for (const Motion& motion : motions) {
          const Step step = guard.step(motion);
          fingerprint.add(step);
          limited += step.status == Status::limited ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(limited, 10'000);
  EXPECT_EQ(fingerprint.text(), recorded("tips"));
}

/// Adds the steps of one robot near a mesh, which may move; the flange may have a guide.
void add_stroke(int stroke, bool meshes_move, bool is_guided, Fingerprint& fingerprint,
                int& limited) {
  Random random(static_cast<std::uint64_t>(100 + stroke));
  const auto mesh = mesh_of(make_shape(meshes[static_cast<std::size_t>(stroke / 2) % 4]));
  const Instrument robot = stroke % 2 == 0 ? psm() : seven_joint_arm();
  const int n = robot.chain().size();
  std::vector<double> q;
  for (int k = 1; k <= n; ++k) {
    const JointLimits& limits = robot.chain().joint(k).limits;
    const double farthest = robot.chain().joint(k).kind == JointKind::prismatic ? 200.0 : 2.0;
    const double low = std::max(limits.lower, -2.0);
    q.push_back(low + (std::min(limits.upper, farthest) - low) * random.uniform(0.3, 0.7));
  }
  const ChainState state = test::state_of(robot.chain(), q);
  const Vec3 tip = state.flange().position;
  const Triangle there =
      mesh->triangle(static_cast<TriangleId>(random.below(mesh->triangle_count())));
  const Vec3 normal = (there[1] - there[0]).cross(there[2] - there[0]).normalized();
  const Vec3 along = (state.flange().rotation.col(2) + 0.6 * random.direction()).normalized();
  const Mat3 turned = rotation_between(normal, -along).toRotationMatrix();
  const Vec3 middle = (there[0] + there[1] + there[2]) / 3.0;
  InstrumentConstraint guard = guard_of(mesh, robot, {.margin = 0.3});
  Twist velocity;
  if (meshes_move) velocity.linear = random.uniform(0.0, 30.0) * random.direction();
  ASSERT_EQ(
      guard.place(0, {tip + random.uniform(2.0, 6.0) * along - turned * middle, turned}, velocity),
      Status::free);
  if (is_guided) {
    guard.set_guides({Guide::point("ball", LinkPoint{n, robot.chain().flange().position},
                                   Region::ball(tip, 3.0))});
  }
  for (int cycle = 0; cycle < 250; ++cycle) {
    const Twist desired{.linear = 0.4 * (along + random.direction()).normalized(),
                        .angular = random.uniform(0.0, 0.01) * random.direction()};
    const InstrumentStep step = guard.step(q, desired);
    fingerprint.add(step);
    limited += step.status == Status::limited ? 1 : 0;
    q = moved(q, step);
  }
}

TEST(SameSteps, OfInstruments) {
#if !defined(__x86_64__) || !defined(__GLIBC__)
  GTEST_SKIP() << "this library rounds sines differently";
#else
  if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "sines are rounded differently without FMA";
  Fingerprint fingerprint;
  int limited = 0;
  for (int stroke = 0; stroke < 40; ++stroke) {
    for (const auto& [moves, is_guided] : {std::pair{false, false}, {true, false}, {false, true}}) {
      ASSERT_NO_FATAL_FAILURE(add_stroke(stroke, moves, is_guided, fingerprint, limited));
    }
  }
  EXPECT_GT(limited, 10'000);
  EXPECT_EQ(fingerprint.text(), recorded("instruments"));
#endif
}

}  // namespace
}  // namespace keepout
