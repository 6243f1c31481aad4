// SPDX-License-Identifier: BSD-3-Clause
// Clients that are late, wrong, hostile or killed. The other tests of the server have the
// OpenIGTLink library as their client: peer_test.cpp.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <cmath>
#include <random>

#include "apps/igtl/running_server.h"
#include "messages.h"
#include "trials.h"

namespace keepout::test::igtl {
namespace {

constexpr double accuracy = 1e-6;  // of a limited step [mm]

Vec3 tip(const RunningServer& server) { return server.session().setpoint_cp()->position; }

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
  EXPECT_EQ(tip(server), above);
  peer.send(transform(above + Vec3(0.1, 0, 0)));
  server.take_and_tick();
  const Vec3 moved = tip(server);
  peer.send(string_message("engage"));
  server.take(1);
  EXPECT_EQ(peer.receive("KeepoutNote").name(), "engaged");
  EXPECT_EQ(tip(server), moved) << "it does not jump to where it was engaged";
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
  EXPECT_NEAR(tip(server).x(), above.x() + 20.0, accuracy);
  server.tick(2);
  EXPECT_EQ(server.session().cycle().status, CycleStatus::stale);
  const Vec3 stood = tip(server);
  server.tick(50);
  EXPECT_EQ(tip(server), stood);
}

TEST(IgtlServer, AHalfMessageMovesNothingUntilItsOtherHalfComes) {
  RunningServer server;
  RawPeer peer(server.port());
  server.engage(peer);
  const ByteList goal = transform(above + Vec3(0.1, 0, 0));
  for (const std::size_t half : {1u, 57u, 58u, 80u, 105u}) {
    const Vec3 before = tip(server);
    peer.send(Bytes(goal).first(half));
    for (int i = 0; i < 150; ++i) {
      (*server).receive(server.moment());
      server.tick();
    }
    EXPECT_EQ(server.session().cycle().status, CycleStatus::stale);
    EXPECT_EQ(tip(server), before);
    peer.send(Bytes(goal).subspan(half));
    server.take_and_tick();
    EXPECT_EQ(server.session().cycle().status, CycleStatus::guarded);
    EXPECT_NEAR((tip(server) - above).norm(), 0.1, 1e-5) << "rounded to floats";
  }
}

TEST(IgtlServer, AWrongMessageMakesTheToolStandStillAlsoIfAValidOneFollows) {
  const ByteList good = transform(above + Vec3(0.05, 0, 0));
  const double nan = test::nan;
  const Pose scaled{above, 2.0 * Mat3::Identity()};
  const struct {
    ByteList message;
    CycleStatus status;
    int code;  // of the answer; 0: none but the state
  } cases[] = {
      {changed(good, 50, 8, 12345), CycleStatus::invalid_pose, 9},
      {message("TRANSFORM", "Tool", Bytes(good).subspan(header_size, 47)),
       CycleStatus::invalid_pose, 10},
      {message("TRANSFORM", "Tool", ByteList(49)), CycleStatus::invalid_pose, 8},
      {changed(good, 0, 2, 2), CycleStatus::invalid_pose, 10},
      {transform(Vec3(0, nan, 0)), CycleStatus::invalid_pose, 0},
      {transform(scaled), CycleStatus::invalid_pose, 0},
      {transform(Pose{above, nan * Mat3::Identity()}), CycleStatus::invalid_pose, 0},
      {transform(Pose{.position = above}, "OtherTool"), CycleStatus::other_frame, 0},
      {transform(Pose{.position = above}, "Tool", 1.6e9), CycleStatus::stale, 7},
  };
  for (const auto& [wrong, status, code] : cases) {
    SCOPED_TRACE(code);
    RunningServer server;
    RawPeer peer(server.port());
    server.engage(peer);
    server.tick();
    peer.send(joined(wrong, good));
    server.take(2);
    server.tick();
    EXPECT_EQ(server.session().cycle().status, status) << server.session().reason();
    EXPECT_EQ(tip(server), above);
    while (true) {
      const RawPeer::Message state = peer.receive("Keepout");
      if (state.name() == name(status)) {
        EXPECT_EQ(state.text(), reason(status));
        break;
      }
    }
    peer.send(good);
    server.take_and_tick();
    EXPECT_TRUE(server.session().cycle().ok()) << "the next cycle follows again";
    EXPECT_NE(tip(server), above);
    EXPECT_EQ(server.counts().refused, code > 0 ? 1u : 0u);
  }
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

TEST(IgtlServer, EndsTheConnectionOfAClientWhoseMessagesCannotBeCut) {
  for (const ByteList& wrong : {changed(transform(above), 42, 8, std::uint64_t{1} << 62),
                                changed(transform(above), 42, 8, (std::uint64_t{64} << 20) + 1),
                                changed(transform(above), 0, 2, 3), ByteList(100, 'x')}) {
    RunningServer server;
    RawPeer peer(server.port());
    server.engage(peer);
    peer.send(wrong);
    server.wait_until([&] { return !server.session().engaged(); });
    const RawPeer::Message note = peer.receive("KeepoutNote");
    EXPECT_CONTAINS(note.text(), "the connection ends");
    while (peer.receive()) {
    }
    RawPeer next(server.port());
    server.engage(next);
  }
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
  EXPECT_EQ(tip(server), above) << "the tool stands still, as two clients want to move it";
  EXPECT_EQ(second.receive("KeepoutNote").code(), 5) << "access denied";
  for (const ByteList& refused :
       {string_message("engage"), string_message("register"),
        point_message("Model", std::vector<Vec3>(3, above)), polydata(tetrahedron())}) {
    second.send(refused);
    server.take(1);
    EXPECT_EQ(second.receive("KeepoutNote").name(), "other_controls");
  }
  server.tick();
  EXPECT_NEAR(tip(server).x(), above.x() + 0.1, 1e-5) << "of the first client";
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

TEST(IgtlServer, ReleasesTheToolIfItsClientIsKilled) {
  RunningServer server;
  RawPeer reader(server.port());
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    RawPeer peer(server.port());
    peer.send(joined(transform(above), string_message("engage")));
    if (::write(ready[1], "x", 1) == 1) ::pause();
    ::_exit(1);
  }
  server.take(2);
  server.tick(3);
  EXPECT_TRUE(server.session().engaged());
  char byte = 0;
  EXPECT_EQ(::read(ready[0], &byte, 1), 1);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  server.wait_until([&] { return !server.session().engaged(); });
  server.tick();
  for (const int file : ready) ::close(file);
  while (true) {
    const RawPeer::Message state = reader.receive("Keepout");
    if (state.text().find("the controlling client has left") != std::string::npos) break;
  }
}

// Each cycle reads a bounded part of the flood, and the tool stays where it may be.
TEST(IgtlServer, AFloodDelaysNoCycle) {
  RunningServer server;
  RawPeer peer(server.port());
  server.engage(peer);
  RawPeer other(server.port());
  ByteList flood;
  for (int i = 0; i < 400; ++i) {
    flood = joined(std::move(flood), transform(Vec3(i % 7, i % 5, top - 10.0 + i % 30)));
  }
  ByteList commands;
  for (int i = 0; i < 200; ++i) commands = joined(std::move(commands), string_message("start"));
  std::size_t at = 0;
  std::size_t most = 0;
  for (int cycle = 0; cycle < trials(2000); ++cycle) {
    at = (at + peer.send(Bytes(flood).subspan(at), MSG_DONTWAIT)) % flood.size();
    other.send(commands, MSG_DONTWAIT);
    const std::size_t before = server.counts().messages;
    (*server).receive(server.moment());
    most = std::max(most, server.counts().messages - before);
    server.tick();
    ASSERT_GE(tip(server).z(), top + kept - accuracy);
  }
  EXPECT_GT(server.counts().messages, 100'000u / 4u);
  const std::size_t size = commands.size() / 200;
  EXPECT_LE(most, 32'768 / 106 + 4'096 / size + 2);
}

TEST(IgtlServer, AClientThatDoesNotReadLosesFramesAndTheOthersDoNot) {
  RunningServer server;
  RawPeer peer(server.port());
  server.engage(peer);
  RawPeer slow(server.port());
  RawPeer reader(server.port());
  (*server).receive(server.moment());
  const int all = 10'000;
  std::size_t frames = 0;
  for (int i = 0; i < all; ++i) {
    if (i % 50 == 0) {
      peer.send(transform(above + Vec3(0.01 * (i % 10), 0, 0)));
      server.take(1);
    }
    server.tick();
    reader.receive("GuardedTool");
    peer.receive("GuardedTool");
    ++frames;
  }
  EXPECT_EQ(frames, static_cast<std::size_t>(all));
  EXPECT_GT(server.counts().dropped, 1000u) << "only the slow client loses frames";
  EXPECT_LT(server.counts().dropped, static_cast<std::size_t>(all));
  std::size_t late = 0;
  slow.send(message("GET_STATUS", "", {}));
  server.take(1);
  server.tick(2000);
  for (; late < 100; ++late) slow.receive("GuardedTool");
  EXPECT_EQ(late, 100u) << "once it reads, it gets whole messages again";
}

TEST(IgtlServer, RefusesTheSeventeenthClient) {
  RunningServer server;
  std::vector<std::unique_ptr<RawPeer>> peers;
  for (std::size_t i = 0; i < Server::most_clients; ++i) {
    peers.push_back(std::make_unique<RawPeer>(server.port()));
    (*server).receive(server.moment());
  }
  RawPeer last(server.port());
  std::thread cycles([&] {
    for (int i = 0; i < 200; ++i) {
      (*server).receive(server.moment());
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  EXPECT_FALSE(last.receive());
  cycles.join();
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
  EXPECT_NEAR(tip(server).z(), top + 3 + kept, accuracy);
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
  EXPECT_NEAR(tip(server).z(), top + kept, accuracy);
}

// The client that controls the tool sends garbled messages. The tool keeps its distance.
TEST(IgtlServer, HostileMessagesNeverMoveTheToolTooClose) {
  std::mt19937_64 random(40);
  RunningServer server;
  auto peer = std::make_unique<RawPeer>(server.port());
  const int all = all_trials() ? 1'000'000 : 10'000;
  int guarded = 0;
  for (int sent = 0; sent < all;) {
    ByteList bytes;
    for (int i = 0; i < 10; ++i, ++sent) {
      const Vec3 goal(3.0 * std::sin(sent), 4.0, top + 3.0 * std::sin(0.01 * sent));
      ByteList one = transform(goal);
      switch (random() % 60) {
        case 0:
          one = random() % 8 == 0 ? string_message("release")
                                  : joined(transform(above), string_message("engage"));
          break;
        case 1:
          one[random() % one.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
          break;
        case 2: {
          const std::vector<float> numbers{NAN, INFINITY, -3e38F, 1e-40F, 1e30F};
          Pose pose{.position = goal};
          (random() % 2 == 0 ? pose.position[0] : pose.rotation(1, 1)) = numbers[random() % 5];
          one = transform(pose);
          break;
        }
        case 3:
          if (random() % 20 == 0) one.resize(random() % one.size());
          break;
      }
      bytes = joined(std::move(bytes), one);
    }
    peer->send(bytes, MSG_DONTWAIT);
    (*server).receive(server.moment());
    server.tick();
    guarded += server.session().cycle().ok() ? 1 : 0;
    if (server.session().engaged()) {
      ASSERT_GE(tip(server).z(), top + kept - accuracy);
    }
    if (random() % 30 == 0) {  // for example because the stream cannot be cut any more
      peer = std::make_unique<RawPeer>(server.port());
    }
  }
  EXPECT_GT(guarded, all / 200) << "the test is meaningful only if the tool moves";
  EXPECT_GT(server.counts().refused, static_cast<std::size_t>(all / 100));
}

}  // namespace
}  // namespace keepout::test::igtl
