// SPDX-License-Identifier: BSD-3-Clause
//
// Steps are bitwise those of docs/records/steps.txt. The records of campaigns stay valid as long as
// the steps are the same. If you change a step on purpose, write the two numbers that the test
// prints to that file, and measure these records again (docs/records.md).
//
// 100,000 steps of each kind have the fingerprints of steps_of_kinds.txt, on each processor. A
// short test makes a tenth of them.

#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <type_traits>

#include "guards.h"
#include "keepout/fixtures/motions.h"
#include "trials.h"

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
  void add(const Polytope& polytope) noexcept {
    add(static_cast<std::uint64_t>(polytope.status));
    for (const HalfSpace& plane : polytope.planes) {
      for (const double number : plane.normal) add(number);
      add(plane.offset);
    }
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

/// Returns the fingerprint of a name in docs/records/steps.txt or another file.
std::string recorded(const std::string& name, const char* path = KEEPOUT_STEPS) {
  std::ifstream file(path);
  for (std::string of, text; file >> of >> text;) {
    if (of == name) return text;
  }
  return "";
}

/// Returns true if the C library rounds sines as on the machine of the records.
bool has_the_sines_of_the_records() {
#if defined(__GLIBC__) && defined(__x86_64__)
  return __builtin_cpu_supports("fma");
#elif defined(__GLIBC__) && defined(__aarch64__)
  return true;  // glibc compiles the same code for FMA
#else
  return false;
#endif
}
constexpr const char* other_sines = "sines are rounded differently without glibc or without FMA";

TEST(SameSteps, OfTips) {
  if (!has_the_sines_of_the_records()) GTEST_SKIP() << "of other shapes: " << other_sines;
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

constexpr int cycles_of_stroke = 250;

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
  // Separate statements here and below, because compilers differ in the order of evaluation.
  if (meshes_move) {
    velocity.linear = random.direction();
    velocity.linear *= random.uniform(0.0, 30.0);
  }
  ASSERT_EQ(
      guard.place(0, {tip + random.uniform(2.0, 6.0) * along - turned * middle, turned}, velocity),
      Status::free);
  if (is_guided) {
    guard.set_guides({Guide::point("ball", LinkPoint{n, robot.chain().flange().position},
                                   Region::ball(tip, 3.0))});
  }
  for (int cycle = 0; cycle < cycles_of_stroke; ++cycle) {
    Twist desired{.linear = 0.4 * (along + random.direction()).normalized()};
    desired.angular = random.direction();
    desired.angular *= random.uniform(0.0, 0.01);
    const InstrumentStep step = guard.step(q, desired);
    fingerprint.add(step);
    limited += step.status == Status::limited ? 1 : 0;
    q = moved(q, step);
  }
}

TEST(SameSteps, OfInstruments) {
  if (!has_the_sines_of_the_records()) GTEST_SKIP() << other_sines;
  Fingerprint fingerprint;
  int limited = 0;
  for (int stroke = 0; stroke < 40; ++stroke) {
    for (const auto& [moves, is_guided] : {std::pair{false, false}, {true, false}, {false, true}}) {
      ASSERT_NO_FATAL_FAILURE(add_stroke(stroke, moves, is_guided, fingerprint, limited));
    }
  }
  EXPECT_GT(limited, 10'000);
  EXPECT_EQ(fingerprint.text(), recorded("instruments"));
}

/// The steps of one kind so far.
struct Tally {
  Fingerprint fingerprint;
  int steps = 0;
  int limited = 0;  // of polytopes: with planes

  template <class AnyStep>
  void add(const AnyStep& step) noexcept {
    fingerprint.add(step);
    ++steps;
    limited += step.status == Status::limited ? 1 : 0;
  }
  void add(const Polytope& polytope) noexcept {
    fingerprint.add(polytope);
    ++steps;
    limited += polytope.planes.empty() ? 0 : 1;
  }
};

constexpr int rounds = 200;
constexpr int steps_of_round = 500;

/// A mesh, its index, and motions near the mesh: four fifths of them in contact. Vertices are
/// rounded to float, because other sines give some shapes other last bits.
struct Scene {
  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<const WideBvh> index;
  std::vector<Motion> motions;

  Scene(int round, double clearance)
      : mesh(mesh_of(as_floats(make_shape(meshes[static_cast<std::size_t>(round / 2) % 4])))),
        index(std::make_shared<const WideBvh>(mesh)) {
    Random random(static_cast<std::uint64_t>(1000 + round));
    motions =
        contact_motions(*mesh, *index, steps_of_round * 4 / 5, {.clearance = clearance}, random);
    for (const Motion& motion :
         unrelated_motions(*mesh, steps_of_round / 5, {.clearance = 1.5 * clearance}, random)) {
      motions.push_back(motion);
    }
  }
};

void add_tips(int round, bool is_guided, Tally& tally) {
  const Scene scene(round, 0.2);
  const int nodes = round % 3 == 0 ? 50 : 0;
  MotionConstraint guard = make_motion_constraint(
      scene.mesh, scene.index,
      {.options = {.tool_radius = round % 4 == 3 ? 0.5 : 0.0, .nodes = nodes},
       .capacity = {.nodes = 64}});
  if (is_guided) {
    const Vec3 center = scene.mesh->bounds().center();
    const double size = scene.mesh->bounds().size().norm();
    guard.set_guides({Guide::point("ball", Region::ball(center, 0.45 * size)),
                      Guide::point("slab", Region::slab(center, Vec3(0.6, 0.0, 0.8), 0.3 * size))});
  }
  for (const Motion& motion : scene.motions) tally.add(guard.step(motion));
}

void add_convex_tools(int round, Tally& tally) {
  const Scene scene(round, 0.3);
  const std::array points{Vec3(0, 0, 0), Vec3(0.2, 0, 0.1), Vec3(0, 0.3, 0.1), Vec3(-0.1, 0, 0.3)};
  const std::array tools{ConvexTool::capsule(points[0], points[3], 0.05),
                         ConvexTool::box({Vec3(-0.1, -0.1, -0.1), Vec3(0.1, 0.1, 0.2)}),
                         ConvexTool::hull(points, 0.02)};
  MotionConstraint guard = make_motion_constraint(
      scene.mesh, scene.index,
      {.options = {.margin = 0.1}, .tool = tools[static_cast<std::size_t>(round) % 3]});
  for (const Motion& motion : scene.motions) tally.add(guard.step(motion));
}

void add_polytopes(int round, Tally& tally) {
  const Scene scene(round, 0.3);
  MotionConstraint guard = make_motion_constraint(scene.mesh, scene.index, {});
  for (const Motion& motion : scene.motions) tally.add(guard.free_polytope(motion.tip, 1.0));
}

struct Strokes {
  bool meshes_move = false;
  bool is_guided = false;
};

void add_instruments(int round, const Strokes& strokes, Tally& tally) {
  for (const int stroke : {2 * round, 2 * round + 1}) {
    add_stroke(stroke, strokes.meshes_move, strokes.is_guided, tally.fingerprint, tally.limited);
    tally.steps += cycles_of_stroke;
  }
}

struct Kind {
  const char* name;
  bool has_sines;
  void (*add)(int round, Tally& tally);
};

constexpr std::array kinds{
    Kind{"tips", false, [](int round, Tally& tally) { add_tips(round, false, tally); }},
    Kind{"tips_with_guides", false, [](int round, Tally& tally) { add_tips(round, true, tally); }},
    Kind{"convex_tools", false, add_convex_tools},
    Kind{"polytopes", false, add_polytopes},
    Kind{"instruments", true, [](int round, Tally& tally) { add_instruments(round, {}, tally); }},
    Kind{"instruments_with_guides", true,
         [](int round, Tally& tally) { add_instruments(round, {.is_guided = true}, tally); }},
    Kind{"instruments_beside_moving_meshes", true,
         [](int round, Tally& tally) { add_instruments(round, {.meshes_move = true}, tally); }}};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

class SameStepsOfKind : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, SameStepsOfKind, testing::ValuesIn(kinds), by_name);

/// Makes the first rounds of a kind, and compares the fingerprints at a tenth and at the end.
void compare(const Kind& kind, int last) {
  Tally tally;
  for (int round = 1; round <= last; ++round) {
    ASSERT_NO_FATAL_FAILURE(kind.add(round - 1, tally));
    ASSERT_EQ(tally.steps, round * steps_of_round);
    if (round != rounds / 10 && round != rounds) continue;
    EXPECT_EQ(tally.fingerprint.text(),
              recorded(kind.name + ("_" + std::to_string(tally.steps)), KEEPOUT_STEPS_OF_KINDS));
  }
  EXPECT_GT(tally.limited, tally.steps / 5);
}

TEST_P(SameStepsOfKind, OnEachProcessor) {
  const Kind& kind = GetParam();
  if (kind.has_sines && !has_the_sines_of_the_records()) GTEST_SKIP() << other_sines;
  if (!test::all_trials()) return compare(kind, rounds / 10);
  on_each_simd_target([&] { compare(kind, rounds); });
}

}  // namespace
}  // namespace keepout
