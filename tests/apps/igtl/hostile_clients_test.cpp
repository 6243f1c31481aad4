// SPDX-License-Identifier: BSD-3-Clause
// Clients that are late, wrong, hostile or killed.
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

TEST(IgtlServer, AHalfMessageMovesNothingUntilItsOtherHalfComes) {
  RunningServer server;
  RawPeer peer(server.port());
  server.engage(peer);
  const ByteList goal = transform(above + Vec3(0.1, 0, 0));
  for (const std::size_t half : {1u, 57u, 58u, 80u, 105u}) {
    const Vec3 before = server.tip();
    peer.send(Bytes(goal).first(half));
    for (int i = 0; i < 150; ++i) {
      (*server).receive(server.moment());
      server.tick();
    }
    EXPECT_EQ(server.session().cycle().status, CycleStatus::stale);
    EXPECT_EQ(server.tip(), before);
    peer.send(Bytes(goal).subspan(half));
    server.take_and_tick();
    EXPECT_EQ(server.session().cycle().status, CycleStatus::guarded);
    EXPECT_NEAR((server.tip() - above).norm(), 0.1, 1e-5) << "rounded to floats";
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
    EXPECT_EQ(server.tip(), above);
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
    EXPECT_NE(server.tip(), above);
    EXPECT_EQ(server.counts().refused, code > 0 ? 1u : 0u);
  }
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
    ASSERT_GE(server.tip().z(), top + kept - accuracy);
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
      ASSERT_GE(server.tip().z(), top + kept - accuracy);
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
