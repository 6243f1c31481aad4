// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/motion_bounds.h"

#include <array>
#include <cstdio>

#include "guards.h"
#include "relative_motion.h"

namespace keepout {
namespace {

constexpr int cells = 64;

/// The tightness of the bounds of many motions: the ratio of the true value to its bound.
struct Tightness {
  double sum = 0.0;
  double largest = 0.0;
  int count = 0;

  void add(double truth, double bound) {
    const double ratio = truth / bound;
    sum += ratio;
    largest = std::max(largest, ratio);
    ++count;
  }
  void report(const std::string& what) const {
    std::printf("%s: truth / bound is %.3f in the mean, %.6f at most, of %d\n", what.c_str(),
                sum / count, largest, count);
  }
};

/// Returns the positions of a point that a link carries, at s = 0, 1/64, ..., 1.
std::array<Vec3, cells + 1> way(const Chain& chain, const std::vector<double>& q,
                                const std::vector<double>& increment, const LinkPoint& point) {
  std::array<Vec3, cells + 1> places;
  std::vector<double> at(q.size());
  ChainState state;
  for (int i = 0; i <= cells; ++i) {
    for (std::size_t k = 0; k < q.size(); ++k) at[k] = q[k] + (double(i) / cells) * increment[k];
    chain.forward_kinematics(at, state);
    places[static_cast<std::size_t>(i)] = state.at(point.link, point.position);
  }
  return places;
}

void judge(const Instrument& robot, const std::string& name, std::uint64_t seed) {
  const Chain& chain = robot.chain();
  Random random(seed);
  Tightness path;
  Tightness bend;
  // A position has a few rounding errors of the chain's length.
  const double rounding = 1e-14 * chain.reach();
  const int motions = test::trials(500'000);
  for (int m = 0; m < motions; ++m) {
    const std::vector<double> q = test::configuration(chain, random);
    std::vector<double> increment;
    for (int k = 1; k <= chain.size(); ++k) {
      const double most = chain.joint(k).kind == JointKind::revolute ? 0.4 : 10.0;
      increment.push_back(random.uniform(-most, most));
      // In every other motion about half of the joints rest: the bounds are tightest there.
      if (m % 2 == 0 && random.below(2) == 0) increment.back() = 0.0;
    }
    const Body& body = robot.bodies()[random.below(robot.bodies().size())];
    LinkPoint point = body.points[random.below(body.points.size())];
    point.position += random.uniform(0.0, body.radius) * random.direction();

    const ChainState state = test::state_of(chain, q);
    const MotionBounds bounds =
        motion_bounds(state, increment, point.link, state.at(point.link, point.position));
    const auto places = way(chain, q, increment, point);
    double length = 0.0;
    double fastest = 0.0;
    double sharpest = 0.0;
    for (std::size_t i = 1; i <= cells; ++i) {
      const double chord = (places[i] - places[i - 1]).norm();
      length += chord;
      fastest = std::max(fastest, cells * chord);
      if (i == cells) break;
      // The second difference is a weighted mean of the second derivative over two sub-intervals.
      const Vec3 turn = places[i + 1] - 2.0 * places[i] + places[i - 1];
      sharpest = std::max(sharpest, cells * cells * turn.norm());
    }
    ASSERT_LE(fastest, bounds.path + cells * 2 * rounding) << name << ", motion " << m;
    ASSERT_LE(length, bounds.path + cells * 2 * rounding) << name << ", motion " << m;
    ASSERT_LE(sharpest, bounds.bend + cells * cells * 4 * rounding) << name << ", motion " << m;
    if (bounds.path > 0.1) path.add(length, bounds.path);
    if (bounds.bend > 0.1) bend.add(sharpest, bounds.bend);
  }
  path.report(name + "_path");
  bend.report(name + "_bend");
  EXPECT_GT(path.count, motions / 4);
  EXPECT_GT(bend.count, motions / 4);
  EXPECT_GT(path.largest, 0.9) << "no bound that is far too wide";
  EXPECT_GT(bend.largest, 0.75) << "no bound that is far too wide";
}

TEST(MotionBounds, NoMotionOfThePsmIsLongerOrBendsMore) { judge(psm(), "psm", 11); }
TEST(MotionBounds, NoMotionOfTheSevenJointArmIsLongerOrBendsMore) {
  judge(seven_joint_arm(), "seven_joint_arm", 12);
}

TEST(MotionBounds, OfAPsmAtOneKilohertzAreThoseThatThePageStates) {
  // docs/joint-space-step-algorithm.md states M / 2 at a lever of 200 mm.
  const Instrument robot = psm();
  const Chain& chain = robot.chain();
  const ChainState state =
      test::state_of(chain, std::vector<double>{0.0, 0.0, 200.0, 0.0, 0.0, 0.0});
  std::vector<double> yaw_and_pitch(6, 0.0);
  std::vector<double> all(6);
  for (std::size_t k = 0; k < 6; ++k) {
    all[k] = 1e-3 * chain.joint(static_cast<int>(k) + 1).limits.velocity;
    if (k < 2) yaw_and_pitch[k] = all[k];
  }
  const Vec3 tip = state.flange().position;
  EXPECT_NEAR(0.5e3 * motion_bounds(state, yaw_and_pitch, 6, tip).bend, 0.4, 0.05);  // [µm]
  EXPECT_NEAR(0.5e3 * motion_bounds(state, all, 6, tip).bend, 4.8, 0.1);
}

TEST(MotionBounds, OfOneJointTheyAreExact) {
  const Chain turning({Joint{}});
  const Chain sliding({Joint{.kind = JointKind::prismatic, .axis = Vec3::UnitX()}});
  const double q[] = {0.3};
  const double increment[] = {-0.2};
  ChainState state = test::state_of(turning, q);
  const MotionBounds arc = motion_bounds(state, increment, 1, Vec3(30, 40, 7));
  EXPECT_DOUBLE_EQ(arc.path, 50 * 0.2);
  EXPECT_DOUBLE_EQ(arc.bend, 50 * 0.2 * 0.2);
  EXPECT_EQ(motion_bounds(state, increment, 0, Vec3(30, 40, 7)).path, 0.0) << "the base";
  sliding.forward_kinematics(q, state);
  EXPECT_DOUBLE_EQ(motion_bounds(state, increment, 1, Vec3(30, 40, 7)).path, 0.2);
  EXPECT_EQ(motion_bounds(state, increment, 1, Vec3(30, 40, 7)).bend, 0.0);
}

// The certificate on motions for which its second-derivative bound is exact, so no smaller bound is
// safe.

/// A point on an arm turns past a wall. It is nearest to the wall in the middle of the turn.
struct TurnPastAWall {
  static constexpr double lever = 100.0;
  static constexpr double turn = 0.04;
  static constexpr double radius = 0.5;

  /// `spare`: the distance in the middle, less the certified one, as a fraction of the sagitta.
  /// `slide`: how far the arm's base slides back, as a fraction of the chord.
  TurnPastAWall(double spare, double slide) {
    const InstrumentOptions options;
    const double due = radius + options.margin - options.band;
    const double sagitta = lever * (1.0 - std::cos(0.5 * turn));
    const double at = lever + due + spare * sagitta;
    const auto mesh = wall(at);
    const Joint base{.kind = JointKind::prismatic,
                     .axis = Vec3::UnitY(),
                     .limits = {.lower = -10.0, .upper = 10.0}};
    auto guard = guard_of(mesh,
                          {Chain({base, {.kind = JointKind::revolute}}),
                           {{"point", {{2, Vec3(lever, 0, 0)}}, radius}}},
                          options);
    const double chord = 2.0 * lever * std::sin(0.5 * turn);
    proof = guard.prove(std::vector<double>{0.0, -0.5 * turn},
                        std::vector<double>{-slide * chord, turn});
    const double nearest = at - due + 3.0 * guard.tolerance();
    clear_share = nearest < lever ? 0.5 - std::acos(nearest / lever) / turn : 1.0;
  }

  MotionProof proof;
  double clear_share;  // until the point is nearer than the certified distance
};

// On the plain arc the separating planes decide. If the base slides back by the chord, the path
// ends where it begins. Then the maximum displacement and the ball about the start decide.
TEST(PathBound, AMotionWhoseMiddleComesTooNearIsNotCertifiedWhole) {
  for (const double slide : {0.0, 1.0}) {
    for (const double missing : {5e-4, 0.01, 0.1, 0.3, 0.45, 0.9}) {
      const TurnPastAWall past(-missing, slide);
      ASSERT_LT(past.clear_share, 0.5);
      EXPECT_LE(past.proof.fraction, past.clear_share) << slide << ' ' << missing;
    }
  }
}

TEST(PathBound, AMotionWhoseMiddleIsJustClearIsCertifiedWhole) {
  for (const double slide : {0.0, 1.0}) {
    for (const double spare : {1e-3, 0.1}) {
      EXPECT_TRUE(TurnPastAWall(spare, slide).proof.is_clear()) << slide << ' ' << spare;
    }
  }
}

/// Returns a position in the frame of a moving mesh, by independent formulas.
Vec3 seen_by(const Pose& mesh, const Twist& way, double share, const Vec3& place) {
  Mat3 rotation = mesh.rotation;
  const double turn = way.angular.norm();
  if (turn > 0.0) {
    rotation = Eigen::AngleAxisd(share * turn, way.angular / turn).toRotationMatrix() * rotation;
  }
  return rotation.transpose() * (place - mesh.position - share * way.linear);
}

// Instrument and mesh both move. The path in the frame of the mesh is longer, and has a larger
// second derivative, than the path in the world. The bounds must hold for it.
TEST(RelativeMotion, NoPointIsElsewhereNorBendsMoreThanIsSaid) {
  const Instrument robot = psm();
  const Chain& chain = robot.chain();
  Budget budget;
  PointMotion motion(robot, budget);
  RelativeMotion seen(robot, motion);
  Random random(5);
  double tightest = 0.0;
  const int motions = test::trials(20'000);
  for (int m = 0; m < motions; ++m) {
    const std::vector<double> q = test::configuration(chain, random);
    JointVector increment{};
    for (int k = 0; k < chain.size(); ++k) {
      const bool turns = chain.joint(k + 1).kind == JointKind::revolute;
      if (m % 3 != 0) {
        increment[static_cast<std::size_t>(k)] = random.uniform(-1, 1) * (turns ? 0.3 : 10.0);
      }
    }
    const Pose mesh{100.0 * random.direction(),
                    Eigen::AngleAxisd(3.0, random.direction()).toRotationMatrix()};
    const Twist way{.linear = random.uniform(0.0, 10.0) * random.direction(),
                    .angular = random.uniform(0.0, 0.3) * random.direction()};
    motion.begin_cycle(q);
    seen.begin_cycle(mesh, way);
    motion.set_trial(increment, CertifiedMotion::actual);
    seen.update_bounds();
    const double rounding = 1e-14 * (chain.reach() + 1000.0);
    for (std::size_t p = 0; p < robot.points().size(); ++p) {
      double sharpest = 0.0;
      for (int c = 0; c <= PointMotion::last_knot; c += 7) {
        const Vec3 expected = seen_by(mesh, way, c / 64.0, motion.points_at(c)[p]);
        ASSERT_LE((seen.points_in_mesh(c)[p] - expected).norm(), rounding);
      }
      for (int c = 1; c < PointMotion::last_knot; ++c) {
        const Vec3 turn = seen.points_in_mesh(c + 1)[p] - 2.0 * seen.points_in_mesh(c)[p] +
                          seen.points_in_mesh(c - 1)[p];
        sharpest = std::max(sharpest, 64.0 * 64.0 * turn.norm());
      }
      ASSERT_LE(sharpest, seen.bend(p) + 64.0 * 64.0 * 4.0 * rounding);
      if (seen.bend(p) > 0.1) tightest = std::max(tightest, sharpest / seen.bend(p));
    }
    for (std::size_t b = 0; b < robot.bodies().size(); ++b) {
      for (int c = 0; c <= PointMotion::last_knot; ++c) {
        for (const std::uint8_t p : robot.points_of(b)) {
          ASSERT_LE((seen.points_in_mesh(c)[p] - seen.start_in_mesh()[p]).norm(),
                    seen.largest_displacement(b) + rounding);
        }
      }
    }
  }
  EXPECT_GT(tightest, 0.9) << "no bound that is far too wide";
}

TEST(RelativeMotion, OfAMeshAtHomeIsThatOfTheWorldToTheBit) {
  const Instrument robot = psm();
  Budget budget;
  PointMotion motion(robot, budget);
  RelativeMotion seen(robot, motion);
  const std::vector<double> q{0.1, -0.2, 80.0, 0.3, 0.1, -0.4};
  motion.begin_cycle(q);
  seen.begin_cycle({}, {});
  motion.set_trial({0.1, 0.1, 3.0}, CertifiedMotion::actual);
  seen.update_bounds();
  EXPECT_EQ(seen.points_in_mesh(17), motion.points_at(17));
  EXPECT_EQ(seen.bend(2), motion.bounds(2).bend);
}

}  // namespace
}  // namespace keepout
