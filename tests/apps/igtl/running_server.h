// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>

#include "apps/igtl/client_messages.h"
#include "apps/igtl/raw_peer.h"
#include "control/guarded_shapes.h"
#include "igtl/server.h"

namespace keepout::test::igtl {

inline constexpr double accuracy = 1e-6;  // of a limited step [mm]

/// A point above the cube.
inline const Vec3 above(3.0, 4.0, top + 5.0);

inline ServerOptions options_of_cube() {
  ServerOptions options;
  options.port = 0;
  options.constraint.options.margin = kept;
  return options;
}

/// A server of the cube whose cycles a test runs itself, with a clock of its own. So all counts and
/// bits are the same on every run.
class RunningServer {
 public:
  explicit RunningServer(ServerOptions options = options_of_cube())
      : period_(1.0 / options.rate), server_(options, cube()) {}

  std::uint16_t port() const { return server_.port(); }
  const CrtkSession& session() const { return server_.session(); }
  const ServerCounts& counts() const { return server_.counts(); }
  Server& operator*() { return server_; }
  Moment moment() const { return moment_; }
  /// Returns the setpoint. Precondition: the tool is engaged.
  Vec3 tip() const { return server_.session().setpoint_cp()->position; }

  /// Receives until this number of messages has come since the last call. The clock stands still
  /// meanwhile.
  void take(std::size_t messages) {
    taken_ += messages;
    wait_until([&] { return server_.counts().messages >= taken_; });
    EXPECT_EQ(server_.counts().messages, taken_);
  }

  /// Receives until a condition holds.
  template <class Condition>
  void wait_until(Condition&& is_met) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!is_met()) {
      server_.receive(moment_);
      if (std::chrono::steady_clock::now() > end) throw Error("it took too long");
    }
  }

  /// Runs cycles, each a period later than the last one.
  void tick(int cycles = 1) {
    for (; cycles > 0; --cycles) {
      moment_.now += period_;
      moment_.unix += period_;
      server_.tick(moment_);
    }
  }

  /// Takes one message, then runs a cycle.
  void take_and_tick() {
    take(1);
    tick();
  }

  /// Prepares a mesh that has come, and exchanges it.
  void exchange_mesh() {
    while (server_.is_preparing()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      tick();
    }
  }

  /// Engages above the cube.
  void engage(RawPeer& peer) {
    peer.send(transform(above));
    take_and_tick();
    peer.send(string_message("engage"));
    take(1);
    ASSERT_TRUE(session().engaged()) << session().reason();
  }

 private:
  double period_;
  Moment moment_{.now = 1000.0, .unix = 1.7e9};
  Server server_;
  std::size_t taken_ = 0;
};

}  // namespace keepout::test::igtl
