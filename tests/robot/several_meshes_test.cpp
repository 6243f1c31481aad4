// SPDX-License-Identifier: BSD-3-Clause
// An instrument beside several meshes. Each mesh has its own pose, velocity and margin.

#include "brute_force.h"
#include "guards.h"
#include "keepout/error.h"

namespace keepout {
namespace {

/// Returns a ball on three slides along the axes: the tool that a MotionConstraint guards.
Instrument ball(double radius) {
  std::vector<Joint> axes;
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
    axes.push_back({.kind = JointKind::prismatic,
                    .axis = axis,
                    .limits = {.lower = -500.0, .upper = 500.0, .velocity = 2000.0}});
  }
  return {Chain(axes), {{"ball", {{3, Vec3::Zero()}}, radius}}};
}

constexpr InstrumentOptions undamped{.damping = 1e-9, .orientation_weight = 0.0};

std::shared_ptr<const Mesh> cube_of(double side) {
  return mesh_of(enlarged(make_cube(20.0), side / 100.0));  // a side of 100
}

/// Returns the clearance of a ball from a mesh at a pose.
double clearance(const Vec3& center, double radius, const Mesh& mesh, const Pose& pose) {
  return distance_to(mesh, pose.rotation.transpose() * (center - pose.position)) - radius;
}

Vec3 moved(const Vec3& at, const InstrumentStep& step) {
  Vec3 to = at;
  for (std::size_t k = 0; k < step.increment.size(); ++k) {
    to[static_cast<Eigen::Index>(k)] += step.increment[k];
  }
  return to;
}

InstrumentStep step_of(InstrumentConstraint& guard, const Vec3& at, const Vec3& way) {
  return guard.step({at.data(), 3}, Twist{.linear = way});
}

TEST(SeveralMeshes, EachIsKeptOffByItsOwnMarginWhereItIsPlaced) {
  const auto left = cube_of(10.0);
  const auto right = cube_of(8.0);
  const double size = 8.0 * std::sqrt(3.0);  // in any orientation
  InstrumentConstraint guard = guard_of(left, ball(1.0), undamped);
  ASSERT_EQ(guard.add_mesh(right, std::make_shared<WideBvh>(right), 0.7), 1u);
  const Pose aside{Vec3(10.0 + 0.5 * size, 1.0, -2.0),
                   Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix()};
  guard.place(1, aside);
  Random random(1);
  Vec3 at(7.5, 0.0, 0.0);
  double nearest_left = 1.0;
  double nearest_right = 1.0;
  int beside[2] = {};
  for (int i = 0; i < test::trials(2000); ++i) {
    const Vec3 way =
        0.6 * random.direction() + Vec3(i / 100 % 2 == 0 ? 0.3 : -0.3, -0.02 * at.y(), 0);
    const InstrumentStep step = step_of(guard, at, way);
    ASSERT_TRUE(step.ok()) << step.reason();
    for (const double share : {0.25, 0.5, 1.0}) {
      const Vec3 there = at + share * (moved(at, step) - at);
      nearest_left = std::min(nearest_left, clearance(there, 1.0, *left, {}));
      nearest_right = std::min(nearest_right, clearance(there, 1.0, *right, aside));
    }
    if (step.nearest_mesh >= 0) ++beside[step.nearest_mesh];
    at = moved(at, step);
  }
  EXPECT_GE(nearest_left, 0.198 - 1e-8);
  EXPECT_LT(nearest_left, 0.201) << "and it got there";
  EXPECT_GE(nearest_right, 0.698 - 1e-8);
  EXPECT_LT(nearest_right, 0.701);
  EXPECT_GT(beside[0], test::trials(40));
  EXPECT_GT(beside[1], test::trials(40));
}

TEST(SeveralMeshes, APlacedMeshIsTheSameAsARobotThatIsPlacedTheOtherWay) {
  const auto mesh = mesh_of("gear");
  const Pose pose{Vec3(300, -200, 100),
                  Eigen::AngleAxisd(1.1, Vec3(3, 1, -2).normalized()).toRotationMatrix()};
  const Instrument instrument = free_ball(0.5);
  const Chain& chain = instrument.chain();
  const std::vector<Joint> joints{chain.joint(1), chain.joint(2), chain.joint(3)};
  InstrumentConstraint home = guard_of(mesh, instrument, undamped);
  InstrumentConstraint away = guard_of(
      mesh,
      Instrument(Chain(joints, pose), {instrument.bodies().begin(), instrument.bodies().end()}),
      undamped);
  away.place(0, pose);
  Random random(2);
  int held = 0;
  int other = 0;
  for (int i = 0; i < test::trials(2000); ++i) {
    const Vec3 at = mesh->bounds().center() + 0.4 * random.uniform(0.9, 1.0) *
                                                  mesh->bounds().size().norm() * random.direction();
    const Vec3 way = 20.0 * random.direction();
    home.forget();
    away.forget();
    const InstrumentStep expected = step_of(home, at, way);
    const InstrumentStep step = step_of(away, at, pose.rotation * way);
    ASSERT_EQ(step.status, expected.status);
    if (!step.ok()) continue;
    held += step.status == Status::limited;
    const double off = (moved(at, step) - moved(at, expected)).norm();
    other += off > 1e-8;
    ASSERT_LE(off, 0.1) << "rounding may choose another triangle of two that are as near";
  }
  EXPECT_LE(other, held / 10);
  EXPECT_GT(held, test::trials(50));
}

// No motion is commanded. The cube approaches, and the ball moves ahead of it at the margin.
TEST(SeveralMeshes, AMeshThatComesOnIsGivenWayTo) {
  const auto cube = cube_of(10.0);
  InstrumentConstraint guard = guard_of(cube, ball(1.0), undamped);
  const Twist coming{.linear = Vec3(50, 0, 0), .angular = Vec3(0, 0, 0.5)};
  guard.place(0, {}, coming);
  Vec3 at(7.0, 0.3, 0.2);
  double before = at.x();
  int limited = 0;
  for (int i = 0; i < 400; ++i) {
    const InstrumentStep step = step_of(guard, at, Vec3::Zero());
    ASSERT_TRUE(step.status == Status::free || step.status == Status::limited) << step.reason();
    ASSERT_EQ(step.clearance_fraction, 1.0);
    limited += step.status == Status::limited;
    at = moved(at, step);
    const Pose& now = guard.place_of(0);
    ASSERT_NEAR(now.position.x(), 0.05 * (i + 1), 1e-9) << "it goes on";
    ASSERT_LE((now.rotation * now.rotation.transpose() - Mat3::Identity()).norm(), 1e-12);
    ASSERT_GE(clearance(at, 1.0, *cube, now), 0.198 - 1e-8);
  }
  EXPECT_GT(at.x() - before, 15.0) << "it was pushed along";
  EXPECT_GT(limited, 300);
}

// The operator presses sideways. The ball moves ahead of the cube, and stays in its corridor.
TEST(SeveralMeshes, AMeshThatComesOnIsGivenWayToWithinTheGuides) {
  const auto cube = cube_of(10.0);
  const Vec3 start(7.0, 0.3, 0.2);
  const Guide corridor =
      Guide::point("corridor", {3, Vec3::Zero()}, Region::slab(start, Vec3(0.1, 1.0, 0.0), 0.5));
  InstrumentConstraint guard = guard_of(cube, ball(1.0), undamped);
  guard.set_guides({corridor});
  guard.place(0, {}, {.linear = Vec3(50, 0, 0), .angular = Vec3(0, 0, 0.5)});
  Vec3 at = start;
  int held = 0;
  for (int i = 0; i < 400; ++i) {
    const InstrumentStep step = step_of(guard, at, Vec3(-0.02, i < 200 ? 0.05 : -0.05, 0.0));
    ASSERT_TRUE(step.ok()) << step.reason();
    ASSERT_EQ(step.clearance_fraction, 1.0) << i;
    held += step.limits.has(Limit::mesh) && step.limits.has(Limit::guide) ? 1 : 0;
    at = moved(at, step);
    ASSERT_GE(clearance(at, 1.0, *cube, guard.place_of(0)), 0.198 - 1e-8) << i;
    ASSERT_LE(corridor.region().excess(at), corridor.band() + 1e-9) << i;
  }
  EXPECT_GT(held, 100);
}

// The cube approaches faster than the joints can move. The step reports a smaller and smaller
// clearance fraction, until it can prove no motion.
TEST(SeveralMeshes, WhatOutrunsTheJointsIsNamed) {
  const auto cube = cube_of(10.0);
  int degraded = 0;
  int stopped = 0;
  Vec3 at = Vec3::Zero();
  InstrumentConstraint guard = guard_of(cube, ball(1.0), undamped);
  for (int trial = 0; trial < 20; ++trial) {
    guard.forget();
    at = Vec3(6.9, 0.01 * trial, 0.0);
    guard.place(0, {}, {.linear = Vec3(2000.0 + 10.0 * trial, 0, 0)});  // joints: up to 2000
    double kept = 0.198;
    for (int i = 0; i < 40; ++i) {
      const double clear_before = clearance(at, 1.0, *cube, guard.place_of(0));
      const InstrumentStep step = step_of(guard, at, Vec3::Zero());
      if (!step.ok()) {
        ASSERT_EQ(step.clearance_fraction, 0.0);
        ASSERT_TRUE(step.increment.empty());
        ++stopped;
        break;
      }
      at = moved(at, step);
      const double clear = clearance(at, 1.0, *cube, guard.place_of(0));
      kept = std::min(0.198, clear_before - 0.002);
      ASSERT_GE(clear, step.clearance_fraction * kept - 1e-8)
          << name(step.status) << " in cycle " << i;
      if (step.status == Status::degraded) {
        ASSERT_LT(step.clearance_fraction, 1.0);
        ++degraded;
      } else {
        ASSERT_EQ(step.clearance_fraction, 1.0);
      }
    }
  }
  EXPECT_GT(degraded, 20);
  EXPECT_GT(stopped, 5);
}

TEST(SeveralMeshes, APlaceThatIsNoneStopsUntilThereIsOne) {
  const auto cube = cube_of(10.0);
  InstrumentConstraint guard = guard_of(cube, ball(1.0), undamped);
  guard.add_mesh(cube, std::make_shared<WideBvh>(cube));
  const Vec3 at(30, 0, 0);
  Mat3 stretched = Mat3::Identity();
  stretched(0, 0) = 1.1;
  const Mat3 mirrored = -Mat3::Identity();
  for (const Pose& bad : {Pose{Vec3(test::nan, 0, 0)}, Pose{Vec3(1e30, 0, 0)},
                          Pose{Vec3::Zero(), stretched}, Pose{Vec3::Zero(), mirrored}}) {
    EXPECT_EQ(guard.place(1, bad), Status::invalid_input);
    EXPECT_EQ(step_of(guard, at, Vec3::UnitX()).status, Status::invalid_input);
    EXPECT_EQ(guard.place(0, {}), Status::free);
    EXPECT_EQ(step_of(guard, at, Vec3::UnitX()).status, Status::invalid_input) << "the other one";
    guard.place(1, {Vec3(0, 20, 0)});
    EXPECT_EQ(step_of(guard, at, Vec3::UnitX()).status, Status::free);
  }
  guard.place(0, {}, {.linear = Vec3(0, test::nan, 0)});
  EXPECT_EQ(step_of(guard, at, Vec3::UnitX()).status, Status::invalid_input);
  guard.place(0, {}, {.angular = Vec3(0, 0, 1001.0)});
  EXPECT_EQ(step_of(guard, at, Vec3::UnitX()).status, Status::invalid_input) << "in 1 ms";
  EXPECT_EQ(step_of(guard, at, Vec3::UnitX()).clearance_fraction, 0.0);
  guard.place(0, {});
  EXPECT_EQ(guard.place(2, {}), Status::invalid_input) << "there are two";
  EXPECT_EQ(step_of(guard, at, Vec3::UnitX()).status, Status::free) << "no mesh was touched";
}

/// Returns a square sheet in the plane z = 0.
std::shared_ptr<const Mesh> sheet_of(double half) {
  return mesh_of(Surface{{{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}},
                         {{0, 1, 2}, {0, 2, 3}}});
}

// The largest accepted distance of a pose depends on the lengths of the scene, not on the last
// pose. Otherwise each pose could be 100 times farther away than the last one. Rounding would
// exceed the margin, and motions would still be certified.
TEST(SeveralMeshes, PlacesDoNotRatchet) {
  const auto sheet = sheet_of(500.0);
  InstrumentConstraint guard = guard_of(sheet, free_ball(1.0), undamped);
  double x = 5e3;
  int accepted = 0;
  for (; x < 1e12; x *= 50.0) {
    if (guard.place(0, {Vec3(x, 0, 0)}) != Status::free) break;
    ++accepted;
    Vec3 at(x, 0, 4.0);
    for (int i = 0; i < 3; ++i) at = moved(at, step_of(guard, at, Vec3(0, 0, -3)));
    EXPECT_GE(at.z(), 1.198 - 1e-6) << x;
    EXPECT_LT(4.0 * guard.tolerance(), guard.options().band) << x;
  }
  EXPECT_EQ(accepted, 1) << "2.5e5 is beyond 100 times the sheet";
}

/// Three slides carry a tip that can retreat from a sheet, which approaches at 20 mm/s for 8 mm.
struct ComingSheet {
  explicit ComingSheet(const std::vector<Body>& others, const Chain& chain = free_ball(1.0).chain())
      : guard(guard_of(sheet_of(50.0), instrument(chain, others), {.orientation_weight = 0.0})) {}

  static Instrument instrument(const Chain& chain, std::vector<Body> bodies) {
    bodies.insert(bodies.begin(), {"tip", {{3, Vec3::Zero()}}, 1.0});
    return {chain, bodies};
  }

  /// Runs all cycles; the operator commands `way` in each of them.
  void run(const Vec3& way) {
    for (int i = 0; i < 400; ++i) {
      const double z = -8.0 + 0.02 * i;
      guard.place(0, {Vec3(0, 0, z)}, {.linear = Vec3(0, 0, 20)});
      const InstrumentStep step = guard.step(q, {.linear = way});
      stopped += step.ok() ? 0 : 1;
      for (const DegradedClearance& each : step.degraded) {
        named[static_cast<std::size_t>(each.body)] += 1;
        dropped[static_cast<std::size_t>(each.body)] += each.is_certified ? 0 : 1;
        EXPECT_LT(each.fraction, 1.0);
        EXPECT_EQ(each.mesh, 0);
      }
      EXPECT_EQ(!step.degraded.empty(), step.status == Status::degraded || !step.ok()) << i;
      q = keepout::moved(q, step);
      least = std::min(least, q[2] - (z + 0.02) - 1.0);
    }
  }

  InstrumentConstraint guard;
  std::vector<double> q{0.0, 0.0, -6.0};
  int stopped = 0;
  int named[3] = {};
  int dropped[3] = {};
  double least = 1.0;  // least clearance of the tip
};

// A body that cannot retreat must not prevent the retreat of others, nor reduce their clearance.
TEST(MovingSheet, TakesNothingFromABodyThatCanRetreat) {
  ComingSheet alone({});
  alone.run(Vec3::Zero());
  EXPECT_EQ(alone.stopped, 0);
  EXPECT_GE(alone.least, 0.198 - 1e-8);
  EXPECT_EQ(alone.named[0], 0);

  const std::vector<Body> posts[] = {{{"ball", {{0, Vec3(5, 0, -4)}}, 1.0}},
                                     {{"shaft", {{0, Vec3(5, 0, -4)}, {0, Vec3(9, 0, 4)}}, 1.0}},
                                     {{"needle", {{0, Vec3(5, 0, -4)}, {0, Vec3(9, 0, 4)}}, 0.0}}};
  for (const std::vector<Body>& post : posts) {
    SCOPED_TRACE(post[0].name);
    ComingSheet beside(post);
    beside.run(Vec3::Zero());
    EXPECT_EQ(beside.stopped, 0);
    EXPECT_GE(beside.least, 0.198 - 1e-8);
    EXPECT_EQ(beside.named[0], 0) << "the tip keeps all of its distance";
    EXPECT_GT(beside.named[1], 40) << "and the post does not";
    EXPECT_GT(beside.dropped[1], 40);
  }
}

// As above, but the body that cannot retreat is on a joint at its limit.
TEST(MovingSheet, TakesNothingFromABodyBesideOneThatIsBlocked) {
  // A slide that moves up to its limit carries a ball. Beyond it, two slides carry the tip.
  std::vector<Joint> joints{{.kind = JointKind::prismatic,
                             .origin = {Vec3(8, 0, 0)},
                             .limits = {.lower = -6.0, .upper = -4.0, .velocity = 1000.0}},
                            {.kind = JointKind::prismatic,
                             .axis = Vec3::UnitX(),
                             .limits = {.lower = -10.0, .upper = 10.0, .velocity = 1000.0}},
                            {.kind = JointKind::prismatic,
                             .limits = {.lower = -50.0, .upper = 50.0, .velocity = 1000.0}}};
  ComingSheet blocked({{"blocked", {{1, Vec3::Zero()}}, 1.0}}, Chain(joints));
  blocked.q = {-5.0, -8.0, 0.0};
  for (int i = 0; i < 400; ++i) {
    const double z = -8.0 + 0.02 * i;
    blocked.guard.place(0, {Vec3(0, 0, z)}, {.linear = Vec3(0, 0, 20)});
    const InstrumentStep step = blocked.guard.step(blocked.q, Twist{});
    blocked.q = keepout::moved(blocked.q, step);
    const double clear = blocked.q[0] + blocked.q[2] - (z + 0.02) - 1.0;
    ASSERT_GE(clear, 0.198 - 1e-8)
        << i << ' ' << name(step.status) << ' ' << step.clearance_fraction;
    for (const DegradedClearance& each : step.degraded) {
      ASSERT_EQ(each.body, 1);
      blocked.named[1] += 1;
    }
  }
  EXPECT_GT(blocked.named[1], 50);
}

// As above, but the other body is beside a second mesh that passes fast. More triangles are in
// reach of the cycle than the capacity holds. Only the proof of a motion detects this.
TEST(MovingSheet, TakesNothingFromABodyBesideOneWithTooManyTriangles) {
  Surface strip;
  for (int i = 0; i < 8000; ++i) {
    const double x = 0.01 * i;
    for (const Vec3& corner : {Vec3(x, -1, 0), Vec3(x + 0.01, -1, 0), Vec3(x, 1, 0)}) {
      strip.vertices.push_back(corner);
    }
    const auto first = static_cast<VertexId>(3 * i);
    strip.triangles.push_back({first, first + 1, first + 2});
  }
  const auto dense = mesh_of(strip);
  const Instrument robot =
      ComingSheet::instrument(free_ball(1.0).chain(), {{"post", {{1, Vec3(20, 0, 40)}}, 1.0}});
  InstrumentConstraint guard =
      guard_of(sheet_of(50.0), robot, {.orientation_weight = 0.0}, {.triangles = 100});
  guard.add_mesh(dense, std::make_shared<const WideBvh>(dense));
  std::vector<double> q{0.0, 0.0, -6.0};
  int dropped = 0;
  for (int i = 0; i < 400; ++i) {
    const double z = -7.2 + 0.02 * i;  // the tip must retreat in each cycle
    guard.place(0, {Vec3(0, 0, z)}, {.linear = Vec3(0, 0, 20)});
    // The end of the strip is too far away to limit the post, and passes below it in the cycle.
    guard.place(1, {Vec3(22, 0, 38.1)}, {.linear = Vec3(-3000, 0, 0)});
    const InstrumentStep step = guard.step(q, Twist{});
    ASSERT_TRUE(step.ok()) << i << ' ' << name(step.status);
    for (const DegradedClearance& each : step.degraded) {
      ASSERT_EQ(each.body, 1);
      ASSERT_EQ(each.mesh, 1);
      dropped += each.is_certified ? 0 : 1;
    }
    q = keepout::moved(q, step);
    ASSERT_GE(q[2] - (z + 0.02) - 1.0, 0.198 - 1e-8) << i;
  }
  EXPECT_GT(dropped, 100);
}

// The velocity of a mesh carries it away, until the margin is too small for the rounding errors.
TEST(SeveralMeshes, AMeshThatGoesTooFarIsNamed) {
  const auto sheet = sheet_of(500.0);
  InstrumentConstraint guard = guard_of(sheet, free_ball(1.0), undamped);
  ASSERT_EQ(guard.place(0, {}, {.linear = Vec3(9e8, 0, 0)}), Status::free);
  EXPECT_EQ(step_of(guard, Vec3(0, 0, 1.25), Vec3::Zero()).status, Status::invalid_input)
      << "9e5 in a cycle is beyond 100 times the sheet";
  ASSERT_EQ(guard.place(0, {}, {.linear = Vec3(4e7, 0, 0)}), Status::free);
  bool ended = false;
  for (int i = 0; i < 40'000; ++i) {
    const double x = guard.place_of(0).position.x();
    const Vec3 at(x, 0, 1.25);
    const InstrumentStep step = step_of(guard, at, Vec3(0, 0, -3));
    if (step.ok()) {
      ASSERT_FALSE(ended);
      ASSERT_LT(4.0 * guard.tolerance(), guard.options().band);
    }
    ended = ended || step.status == Status::margin_too_small;
  }
  EXPECT_TRUE(ended);
  EXPECT_EQ(guard.place(0, {}), Status::free);
  EXPECT_TRUE(step_of(guard, Vec3(0, 0, 1.25), Vec3::Zero()).ok()) << "and it can come back";
}

// A body that no joint moves is too close to a mesh at rest. The step must still move the other
// bodies, for any pose of the mesh and any rounding of the pose.
TEST(SeveralMeshes, WhatNoJointCanDoIsNotAskedFor) {
  const auto cube = cube_of(10.0);
  const Instrument free = free_ball(1.0);
  std::vector<Joint> joints;
  for (int k = 1; k <= 3; ++k) joints.push_back(free.chain().joint(k));
  Random random(3);
  for (int i = 0; i < test::trials(200); ++i) {
    const Vec3 axis = random.direction();
    const Pose pose{10.0 * random.direction(),
                    Eigen::AngleAxisd(random.uniform(0.0, 3.0), axis).toRotationMatrix()};
    const Vec3 above = pose * Vec3(0.3, 0.1, 6.1);  // 0.1 more than its radius off a face
    const Instrument instrument(Chain(joints),
                                {{"post", {{0, above}}, 1.0}, {"ball", {{3, Vec3::Zero()}}, 1.0}});
    InstrumentConstraint guard = guard_of(cube, instrument, {.orientation_weight = 0.0});
    guard.place(0, pose);
    for (const Vec3& way : {Vec3(0, 0, 0), Vec3(1e-9, 0, 0), Vec3(-0.1, 0, 0)}) {
      const InstrumentStep step = step_of(guard, Vec3(-40, 0, 40), way);
      ASSERT_EQ(step.status, Status::recovering) << step.reason();
    }
  }
}

// A motion may use at most half of the distance of a body that is too close.
TEST(SeveralMeshes, ABodyThatIsTooCloseNeverUsesUpItsDistance) {
  const auto cube = cube_of(10.0);
  InstrumentConstraint guard =
      guard_of(cube, free_ball(1.0), {.margin = 0.5, .band = 0.05, .recovery = 0.0});
  for (const double distance : {0.2, 0.05, 0.01, 0.001}) {
    guard.forget();
    const Vec3 at(6.0 + distance, 0.1, 0.2);
    const MotionProof proof = guard.prove({at.data(), 3}, std::vector<double>{-0.1, 0, 0});
    EXPECT_EQ(proof.status, Status::recovering);
    EXPECT_GE(distance - 0.1 * proof.fraction, 0.5 * distance - 1e-9);
    const Vec3 to = moved(at, step_of(guard, at, Vec3(-1, 0, 0)));
    EXPECT_GE(clearance(to, 1.0, *cube, {}), 0.5 * distance - 1e-9);
  }
}

TEST(SeveralMeshes, SaysWhatIsWrongWithOneAndStaysAsItWas) {
  const auto cube = cube_of(10.0);
  const auto index = std::make_shared<WideBvh>(cube);
  InstrumentConstraint guard = guard_of(cube, ball(1.0), undamped);
  EXPECT_THROW(guard.add_mesh(nullptr, index), Error);
  EXPECT_THROW(guard.add_mesh(cube_of(10.0), index), Error) << "of another mesh";
  EXPECT_THROW(guard.add_mesh(cube, index, 0.001), Error) << "below the band";
  EXPECT_THROW(guard.add_mesh(cube, index, test::nan), Error);
  EXPECT_THROW(guard.add_mesh(cube, index, test::infinity), Error);
  EXPECT_THROW(guard.follow(cube, index, 1), Error);
  EXPECT_EQ(guard.mesh_count(), 1u);
  EXPECT_TRUE(step_of(guard, Vec3(30, 0, 0), Vec3::UnitX()).ok());
  for (std::size_t m = 1; m < InstrumentCapacity::most_meshes; ++m) {
    EXPECT_EQ(guard.add_mesh(cube, index, 0.5), m);
  }
  EXPECT_THROW(guard.add_mesh(cube, index), Error);
  InstrumentOptions wide = guard.options();
  wide.band = 0.6;
  wide.margin = 1.0;
  EXPECT_THROW(guard.set_options(wide), Error) << "wider than the margin of some mesh";
}

// The refused mesh does not change the next step, nor its work.
TEST(SeveralMeshes, OneThatIsRefusedTakesNothingFromABodyThatIsTooClose) {
  const auto cube = cube_of(10.0);
  const auto index = std::make_shared<WideBvh>(cube);
  const auto vast = cube_of(1e13);
  const auto index_of_vast = std::make_shared<WideBvh>(vast);
  const InstrumentOptions options{.margin = 0.5, .band = 0.05, .recovery = 0.0};
  InstrumentConstraint guard = guard_of(cube, free_ball(1.0), options);
  InstrumentConstraint undisturbed = guard_of(cube, free_ball(1.0), options);
  Vec3 at(6.2, 0.1, 0.2);
  for (int i = 0; i < 6; ++i) {
    SCOPED_TRACE(i);
    const InstrumentStep step = step_of(guard, at, Vec3(-1, 0.1, 0));
    const InstrumentStep expected = step_of(undisturbed, at, Vec3(-1, 0.1, 0));
    ASSERT_TRUE(step.ok()) << step.reason();
    EXPECT_EQ(step.status, expected.status);
    EXPECT_EQ(moved(at, step), moved(at, expected));
    EXPECT_EQ(guard.work_units(), undisturbed.work_units());
    at = moved(at, step);
    if (i % 2 == 0) {
      EXPECT_THROW(guard.add_mesh(cube, index, 0.001), Error) << "below the band";
    } else {
      EXPECT_THROW(guard.follow(vast, index_of_vast), Error) << "the margin is lost in rounding";
    }
    EXPECT_EQ(guard.tolerance(), undisturbed.tolerance());
  }
  EXPECT_GE(clearance(at, 1.0, *cube, {}), 0.15 - 1e-9);
}

TEST(SeveralMeshes, IsFollowedWhereItIs) {
  const auto cube = cube_of(10.0);
  InstrumentConstraint guard = guard_of(cube, ball(1.0), undamped);
  guard.add_mesh(cube, std::make_shared<WideBvh>(cube), 0.4);
  guard.place(1, {Vec3(20, 0, 0)});
  const auto larger = cube_of(12.0);
  guard.follow(larger, std::make_shared<WideBvh>(larger), 1);
  EXPECT_EQ(guard.place_of(1).position.x(), 20.0);
  EXPECT_EQ(&guard.mesh(1), larger.get());
  Vec3 at(10, 0, 0);
  for (int i = 0; i < 20; ++i) at = moved(at, step_of(guard, at, Vec3::UnitX()));
  EXPECT_NEAR(at.x(), 20.0 - 6.0 - 1.0 - 0.4, 2e-3);
}

// The velocity damper allows at most a fraction of the remaining distance per cycle, and does not
// slow motion along the surface.
TEST(Slowing, UsesUpAShareOfTheWayThatIsLeft) {
  const auto cube = cube_of(10.0);
  InstrumentConstraint guard = guard_of(
      cube, ball(1.0),
      {.slowing_within = 2.0, .slowing_time = 0.02, .damping = 1e-9, .orientation_weight = 0.0});
  Vec3 at(9.5, 0, 0);  // 3.5 from the cube
  const double share = 1e-3 / 0.02;
  const Vec3 near(6.5, 0, 0);
  EXPECT_TRUE(guard.prove({near.data(), 3}, std::vector<double>{-0.29, 0, 0}).is_clear())
      << "proofs are not slowed down";
  int slowed = 0;
  double slowest = 1.0;  // motion along the surface
  for (int i = 0; i < 200; ++i) {
    const double left = clearance(at, 1.0, *cube, {}) - 0.2;
    const InstrumentStep step = step_of(guard, at, Vec3(-0.3, 0.01, 0.0));
    ASSERT_TRUE(step.ok());
    const Vec3 to = moved(at, step);
    slowest = std::min(slowest, to.y() - at.y());
    if (left < 2.0) {
      const double now = clearance(to, 1.0, *cube, {}) - 0.2;
      ASSERT_GE(now, (1.0 - share) * left - 0.002 - 1e-8);
      ++slowed;
    }
    at = to;
  }
  EXPECT_GT(slowed, 150);
  EXPECT_GT(slowest, 0.0099) << "along the surface nothing is slowed";
  EXPECT_LT(clearance(at, 1.0, *cube, {}), 0.21) << "and it arrives";
}

}  // namespace
}  // namespace keepout
