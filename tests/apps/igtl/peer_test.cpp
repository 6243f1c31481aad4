// SPDX-License-Identifier: BSD-3-Clause
// The OpenIGTLink library as the client of our server. Skipped if the library is not installed.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "apps/igtl/running_server.h"
#include "keepout/control/haptic_proxy.h"
#include "keepout/control/rigid_fit.h"
#include "keepout/geometry/closest_point.h"
#include "trials.h"
#if KEEPOUT_HAS_OPENIGTLINK
#include "apps/igtl/library_peer.h"
#endif

namespace keepout::test::igtl {
namespace {

#if !KEEPOUT_HAS_OPENIGTLINK

TEST(IgtlPeer, TheLibraryIsTheClient) { GTEST_SKIP() << "libopenigtlink-dev is not installed"; }

#else

LibraryPeer::Matrix matrix_of(const Pose& pose) {
  LibraryPeer::Matrix matrix = {};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) matrix[i][j] = static_cast<float>(pose.rotation(i, j));
    matrix[i][3] = static_cast<float>(pose.position[i]);
  }
  matrix[3][3] = 1.0F;
  return matrix;
}

LibraryPeer::Matrix matrix_of(const Vec3& tip) { return matrix_of(Pose{.position = tip}); }

Vec3 position(const LibraryPeer::Matrix& matrix) {
  return {matrix[0][3], matrix[1][3], matrix[2][3]};
}

std::vector<LibraryPeer::Point> as_points(std::span<const Vec3> points) {
  std::vector<LibraryPeer::Point> floats;
  for (const Vec3& p : points) {
    floats.push_back(
        {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  return floats;
}

Vec3 rounded_to_floats(const Vec3& point) { return point.cast<float>().cast<double>(); }

void engage(RunningServer& server, LibraryPeer& peer, const Pose& start) {
  peer.send_transform("Tool", matrix_of(start));
  server.take_and_tick();
  peer.send_string("engage");
  server.take(1);
  ASSERT_TRUE(server.session().engaged()) << server.session().reason();
}

TEST(IgtlPeer, ATransformHasTheSameBytesAsThatOfTheLibrary) {
  Random random(1);
  for (int i = 0; i < trials(400); ++i) {
    const Pose pose{Vec3(random.uniform(-300, 300), random.uniform(-1, 1), -0.0),
                    turned(random.uniform(-3, 3))};
    ByteList ours;
    write_transform(ours, "Guard", 1.5, pose);
    const LibraryPeer::Matrix matrix = matrix_of(pose);
    EXPECT_EQ(ours, LibraryPeer::packed_transform("Guard", matrix));
    const auto read = read_transform(Bytes(ours).subspan(header_size));
    ASSERT_TRUE(read);
    EXPECT_EQ(matrix_of(*read), matrix) << "read and written again, no bit changes";
  }
}

// The operator presses the tool into the cube, slides and turns it. A proxy of our own gets the
// same goals, rounded to floats as in the messages.
TEST(IgtlPeer, SetpointsAreThoseOfADirectConstraintRoundedToFloats) {
  RunningServer server;
  LibraryPeer peer(server.port());
  const Vec3 start = rounded_to_floats(above);
  engage(server, peer, {.position = start});
  HapticProxy direct(guard_of(cube()), {});
  ASSERT_EQ(direct.engage(start), CycleStatus::guarded);
  int limited = 0;
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.001 * i;
    const Pose goal{above + Vec3(8 * std::sin(2 * t), 6 * t, -12 * std::abs(std::sin(3 * t))),
                    turned(t)};
    peer.send_transform("Tool", matrix_of(goal));
    server.take_and_tick();
    const HapticCycle expected = direct.cycle(rounded_to_floats(goal.position));
    limited += expected.limits.has(Limit::mesh) ? 1 : 0;
    const LibraryPeer::Message sent = peer.receive("GuardedTool");
    ASSERT_EQ(sent.type, "TRANSFORM");
    ASSERT_EQ(sent.matrix, matrix_of(Pose{expected.proxy, goal.rotation})) << i;
  }
  EXPECT_GT(limited, 1000) << "the test is meaningful only if the mesh limits the tool";
  EXPECT_EQ(server.counts().dropped, 0u);
}

TEST(IgtlPeer, ReadsTheReasonsAndTheActiveTriangles) {
  RunningServer server;
  LibraryPeer peer(server.port());
  LibraryPeer reader(server.port());
  engage(server, peer, {.position = above});
  std::set<std::string> states;
  LibraryPeer::Message triangles;
  const auto read_to_the_next_tool = [&] {
    while (true) {
      LibraryPeer::Message message = reader.receive();
      if (message.device == "Keepout") states.insert(message.name);
      if (message.device == "ActiveTriangles") triangles = message;
      if (message.device == "GuardedTool") return position(message.matrix);
    }
  };
  Vec3 tip;
  for (int i = 0; i < 150; ++i) {
    peer.send_transform("Tool", matrix_of(Vec3(above - Vec3(0, 0, 20))));
    server.take_and_tick();
    tip = read_to_the_next_tool();
  }
  EXPECT_NEAR(tip.z(), top + kept, 1e-5);
  for (int i = 0; i < 200; ++i) {
    server.tick();
    read_to_the_next_tool();
  }
  EXPECT_TRUE(states.contains("guarded"));
  EXPECT_TRUE(states.contains("stale"));
  std::size_t expected = 0;
  const double reach = kept + HapticOptions{}.top_speed * HapticOptions{}.period;
  for (TriangleId t = 0; t < cube()->triangle_count(); ++t) {
    if (closest_point(cube()->triangle(t), server.session().cycle().proxy).distance <= reach) {
      ++expected;
    }
  }
  EXPECT_GT(expected, 0u);
  EXPECT_EQ(triangles.triangles.size(), expected);
  EXPECT_EQ(triangles.points.size(), 3 * expected);
  for (const auto& point : triangles.points) EXPECT_EQ(point[2], static_cast<float>(top));

  reader.send_string("release");
  server.take(1);
  server.tick(40);
  bool is_empty = false;
  while (!is_empty || !states.contains("not_engaged")) {
    const LibraryPeer::Message message = reader.receive();
    if (message.device == "Keepout") states.insert(message.name);
    if (message.device == "ActiveTriangles") is_empty = message.points.empty();
  }
}

// With an attribute, as Slicer sends it.
TEST(IgtlPeer, AMeshThatTheLibrarySendsGuardsTheTool) {
  RunningServer server;
  LibraryPeer peer(server.port());
  const Surface higher = moved(surface_of(*cube()), Vec3(0, 0, 3));
  peer.send_polydata(as_points(higher.vertices), higher.triangles);
  server.take(1);
  server.exchange_mesh();
  EXPECT_EQ(peer.receive("KeepoutNote").name, "mesh");
  engage(server, peer, {.position = above});
  LibraryPeer::Message last;
  for (int i = 0; i < 100; ++i) {
    peer.send_transform("Tool", matrix_of(Vec3(above - Vec3(0, 0, 20))));
    server.take_and_tick();
    last = peer.receive("GuardedTool");
  }
  EXPECT_NEAR(position(last.matrix).z(), top + 3 + kept, 1e-5);
}

TEST(IgtlPeer, FiducialsRegisterTheToolToTheMesh) {
  RunningServer server;
  LibraryPeer peer(server.port());
  const Pose mesh_from_tool{Vec3(30, -20, 10), turned(0.7)};
  const std::vector<Vec3> measured{{0, 0, 0}, {0, 80, 0}, {-60, 0, 0}, {0, 0, 70}, {-50, 60, -40}};
  std::vector<Vec3> model;
  for (const Vec3& point : measured) model.push_back(rounded_to_floats(mesh_from_tool * point));
  peer.send_points("Measured", as_points(measured));
  peer.send_points("Model", as_points(model));
  peer.send_string("register");
  server.take(3);
  const LibraryPeer::Message note = peer.receive("KeepoutNote");
  EXPECT_EQ(note.name, "registered");
  EXPECT_EQ(note.text.substr(0, 7), "5 pairs");

  const auto registration = Registration::mesh_from_robot(fit_rigid(measured, model).matrix(),
                                                          {.transform = LengthUnit::millimetre,
                                                           .robot = LengthUnit::millimetre,
                                                           .mesh = LengthUnit::millimetre});
  const Vec3 start = rounded_to_floats(registration.point_to_robot(above));
  engage(server, peer, {.position = start});
  HapticProxy direct(guard_of(cube()), {});
  direct.engage(registration.point_to_mesh(start));
  LibraryPeer::Message last;
  for (int i = 0; i < 200; ++i) {
    const Vec3 goal = rounded_to_floats(registration.point_to_robot(above - Vec3(0, 0.1 * i, 20)));
    peer.send_transform("Tool", matrix_of(goal));
    server.take_and_tick();
    last = peer.receive("GuardedTool");
    const HapticCycle expected = direct.cycle(registration.point_to_mesh(goal));
    ASSERT_EQ(position(last.matrix),
              rounded_to_floats(registration.point_to_robot(expected.proxy)));
  }
  EXPECT_NEAR((mesh_from_tool * position(last.matrix)).z(), top + kept, 1e-4);

  peer.send_points("Measured", as_points(measured));
  peer.send_points("Model", as_points(model));
  peer.send_string("register");
  server.take(3);
  EXPECT_EQ(peer.receive("KeepoutNote").name, "engaged");
  peer.send_string("release");
  server.take(1);
  model[2] += Vec3(0, 0, 25);  // one fiducial is wrong
  peer.send_points("Model", as_points(model));
  peer.send_string("register");
  server.take(2);
  EXPECT_EQ(peer.receive("KeepoutNote").name, "not_registered");
}

#endif

}  // namespace
}  // namespace keepout::test::igtl
