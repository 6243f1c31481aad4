// SPDX-License-Identifier: BSD-3-Clause
// The answers of the server to its clients. Hostile clients: hostile_clients_test.cpp. The
// OpenIGTLink library as the client: peer_test.cpp.
#include <gtest/gtest.h>

#include "apps/igtl/running_server.h"
#include "messages.h"
#include "realtime/counted_allocations.h"
#include "trials.h"

namespace keepout::test::igtl {
namespace {

TEST(IgtlServer, SendsNothingToMoveUntilItIsEngaged) {
  RunningServer server;
  RawPeer peer(server.port());
  peer.send(transform(above));
  server.take_and_tick();
  const auto state = peer.receive();
  ASSERT_TRUE(state);
  EXPECT_EQ(state->header.device_name(), "Keepout");
  EXPECT_EQ(state->name(), "not_engaged");
  server.engage(peer);
  server.tick();
  EXPECT_EQ(peer.receive("Keepout").name(), "guarded");
  EXPECT_EQ(server.tip(), above);
  peer.send(transform(above + Vec3(0.1, 0, 0)));
  server.take_and_tick();
  const Vec3 moved = server.tip();
  peer.send(string_message("engage"));
  server.take(1);
  EXPECT_EQ(peer.receive("KeepoutNote").name(), "engaged");
  EXPECT_EQ(server.tip(), moved) << "it does not jump to where it was engaged";
}

TEST(IgtlServer, EngagesOnlyWhereAToolIs) {
  RunningServer server;
  RawPeer peer(server.port());
  peer.send(string_message("engage"));
  server.take(1);
  EXPECT_FALSE(server.session().engaged());
  EXPECT_EQ(peer.receive("KeepoutNote").code(), 13) << "not ready";
  peer.send(transform(Vec3(0, 0, 5000)));
  server.take_and_tick();
  peer.send(string_message("engage\n"));
  server.take(1);
  EXPECT_FALSE(server.session().engaged());
  EXPECT_EQ(peer.receive("KeepoutNote").name(), "far_from_mesh");
}

TEST(IgtlServer, StandsStillWhileNoGoalComes) {
  RunningServer server;
  RawPeer peer(server.port());
  server.engage(peer);
  peer.send(transform(above + Vec3(30, 0, 0)));
  server.take_and_tick();
  server.tick(99);  // the last goal is used for 0.1 s, in which the tool moves 20 mm
  EXPECT_NEAR(server.tip().x(), above.x() + 20.0, accuracy);
  server.tick(2);
  EXPECT_EQ(server.session().cycle().status, CycleStatus::stale);
  const Vec3 stood = server.tip();
  server.tick(50);
  EXPECT_EQ(server.tip(), stood);
}

TEST(IgtlServer, AnAnswerTellsWhyAMessageIsRefused) {
  const ByteList pose = transform(above);
  const std::vector<Vec3> points(3, Vec3::Zero());
  const struct {
    ByteList message;
    std::string_view name;
    std::string_view text;
  } cases[] = {
      {changed(pose, 50, 8, 12345), "wrong_crc", "CRC is wrong"},
      {message("TRANSFORM", "Tool", ByteList(49)), "too_long", "too long for its type"},
      {message("TRANSFORM", "Tool", ByteList(47)), "wrong_size", "has 48 bytes"},
      {message("POINT", "Model", ByteList(137)), "wrong_size", "136 bytes"},
      {point_message("Points", points), "unknown_list", "'Measured'"},
      {string_message("start"), "unknown_command", "'engage', 'release' and 'register'"},
      {message("STRING", "", ByteList(3)), "unknown_command", "'engage'"},
      {message("IMAGE", "", ByteList(2000)), "unknown_type", "TRANSFORM, STRING, POINT"},
      {string_message("register"), "not_registered", "at least three pairs"},
  };
  for (const auto& [wrong, name, text] : cases) {
    SCOPED_TRACE(name);
    RunningServer server;
    RawPeer peer(server.port());
    peer.send(wrong);
    server.take(1);
    const RawPeer::Message note = peer.receive("KeepoutNote");
    EXPECT_EQ(note.name(), name);
    EXPECT_CONTAINS(note.text(), text);
    EXPECT_EQ(server.counts().refused, 1u);
  }
  RunningServer server;
  RawPeer peer(server.port());
  for (const char* ignored : {"STATUS", "CAPABILITY", "GET_STATUS", "STT_TDATA"}) {
    peer.send(message(ignored, "", ByteList(40)));
  }
  server.take(4);
  EXPECT_EQ(server.counts().refused, 0u) << "Slicer and the library send them by themselves";
}

TEST(IgtlServer, ASecondClientReadsButDoesNotControl) {
  RunningServer server;
  RawPeer first(server.port());
  server.engage(first);
  RawPeer second(server.port());
  first.send(transform(above + Vec3(0.1, 0, 0)));
  server.take(1);
  second.send(transform(above + Vec3(0, 0.1, 0)));
  server.take(1);
  server.tick();
  EXPECT_EQ(server.session().cycle().status, CycleStatus::contested);
  EXPECT_EQ(server.tip(), above) << "the tool stands still, as two clients want to move it";
  EXPECT_EQ(second.receive("KeepoutNote").code(), 5) << "access denied";
  for (const ByteList& refused :
       {string_message("engage"), string_message("register"),
        point_message("Model", std::vector<Vec3>(3, above)), polydata(tetrahedron())}) {
    second.send(refused);
    server.take(1);
    EXPECT_EQ(second.receive("KeepoutNote").name(), "other_controls");
  }
  server.tick();
  EXPECT_NEAR(server.tip().x(), above.x() + 0.1, 1e-5) << "of the first client";
  EXPECT_EQ(second.receive("GuardedTool").body.size(), transform_size);

  second.send(string_message("release"));
  server.take(1);
  EXPECT_FALSE(server.session().engaged()) << "each client may stop the tool";
  first.close();
  server.wait_until([&] {
    second.send(transform(above));
    server.tick();
    second.send(string_message("engage"));
    (*server).receive(server.moment());
    return server.session().engaged();
  });
}

TEST(IgtlServer, AnOldStampMakesTheToolStandStillUnlessStampsAreIgnored) {
  for (const Stamps stamps : {Stamps::checked, Stamps::ignored}) {
    ServerOptions options = options_of_cube();
    options.stamps = stamps;
    RunningServer server(options);
    RawPeer peer(server.port());
    server.engage(peer);
    const Pose goal{.position = above + Vec3(0.1, 0, 0)};
    for (const double age : {0.05, 0.2, -0.2}) {
      peer.send(transform(goal, "Tool", server.moment().unix - age));
      server.take_and_tick();
      const bool is_used = stamps == Stamps::ignored || age == 0.05;
      EXPECT_EQ(server.session().cycle().status,
                is_used ? CycleStatus::guarded : CycleStatus::stale);
    }
  }
}

TEST(IgtlServer, GuardsFromAMeshThatIsSentWhileTheToolIsReleased) {
  RunningServer server;
  RawPeer peer(server.port());
  server.engage(peer);
  const ByteList higher = polydata(moved(surface_of(*cube()), Vec3(0, 0, 3)), true);
  peer.send(higher);
  server.take(1);
  EXPECT_EQ(peer.receive("KeepoutNote").name(), "engaged");
  EXPECT_FALSE((*server).is_preparing());
  EXPECT_TRUE(server.session().engaged()) << "the refused mesh does not stop the tool";

  peer.send(joined(string_message("release"), higher));
  server.take(2);
  peer.send(joined(string_message("engage"), higher));
  server.take(2);
  EXPECT_FALSE(server.session().engaged());
  EXPECT_EQ(peer.receive("KeepoutNote").name(), "preparing");
  server.exchange_mesh();
  RawPeer::Message note = peer.receive("KeepoutNote");
  while (note.name() == "preparing") note = peer.receive("KeepoutNote");  // of the second mesh
  EXPECT_EQ(note.name(), "mesh");
  EXPECT_CONTAINS(note.text(), "triangles");

  server.engage(peer);
  for (int i = 0; i < 100; ++i) {
    peer.send(transform(above - Vec3(0, 0, 20)));
    server.take_and_tick();
  }
  EXPECT_NEAR(server.tip().z(), top + 3 + kept, accuracy);
}

TEST(IgtlServer, ARefusedMeshLeavesTheLastOne) {
  RunningServer server;
  RawPeer peer(server.port());
  Surface flat = single_triangle();
  flat.vertices[1].x() = test::nan;
  ByteList damaged = polydata(tetrahedron());
  damaged.back() ^= 1;
  for (const auto& [wrong, text] :
       {std::pair(polydata(flat), "not finite"), std::pair(polydata(Surface{}), "no triangle"),
        std::pair(message("POLYDATA", "", ByteList(39)), "too short"),
        std::pair(damaged, "CRC is wrong")}) {
    peer.send(wrong);
    server.take(1);
    server.exchange_mesh();
    EXPECT_CONTAINS(peer.receive("KeepoutNote").text(), text);
  }
  server.engage(peer);
  for (int i = 0; i < 100; ++i) {
    peer.send(transform(above - Vec3(0, 0, 20)));
    server.take_and_tick();
  }
  EXPECT_NEAR(server.tip().z(), top + kept, accuracy);
}

TEST(IgtlServer, AllocatesNothingWhileTheToolIsEngaged) {
  RunningServer server;
  RawPeer peer(server.port());
  server.engage(peer);
  server.tick(10);
  for (int i = 0; i < 1000; ++i) {
    const ByteList goal = transform(above - Vec3(0, 0.01 * i, 0.02 * i));
    peer.send(goal);
    const std::size_t before = allocations();
    server.take_and_tick();
    ASSERT_EQ(allocations(), before) << i;
    while (peer.receive()->header.device_name() != "GuardedTool") {
    }
  }
}

}  // namespace
}  // namespace keepout::test::igtl
