// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "igtl/bodies.h"
#include "igtl/connection.h"
#include "keepout/buffer.h"
#include "keepout/control/crtk_session.h"
#include "keepout/factory/make_motion_constraint.h"

namespace keepout::app::igtl {

/// The treatment of the time stamps of TRANSFORM messages.
enum class Stamps : std::uint8_t {
  checked,  // an old message is refused; a stamp of 0 counts as the time of arrival
  ignored   // each message counts as sent when it arrives
};

struct ServerOptions {
  std::string address = "127.0.0.1";  // to listen at, IPv4
  std::uint16_t port = 18944;         // 0: any free one
  unsigned rate = 1000;               // cycles in a second [Hz]
  std::string device = "Tool";        // the name of the tool's TRANSFORM
  double longest_silence = 0.1;       // the last TRANSFORM is used for this time [s]
  Stamps stamps = Stamps::checked;
  std::size_t longest_body = std::size_t{64} << 20;  // of a message [bytes]
  MotionConstraintSettings constraint = {};
  std::vector<Guide> guides = {};  // of the tip, in the frame of the mesh
};

/// The time of a cycle.
struct Moment {
  double now;   // by a clock that does not jump [s]
  double unix;  // since 1970, as in time stamps [s]
};

/// Counts since the start.
struct ServerCounts {
  std::size_t messages = 0;  // complete messages of clients
  std::size_t refused = 0;   // messages of clients
  std::size_t dropped = 0;   // frames and notes that slow clients did not get
};

/// An OpenIGTLink server that guards the tip of one tool. See docs/slicer.md for its messages. One
/// thread calls receive() and tick() in turn; neither waits for a client. While the tool is engaged
/// they do not allocate, except for the text of a refused message.
class Server {
 public:
  static constexpr std::size_t most_clients = 16;

  /// Listens. Throws Error for an option out of range, or for an address that cannot be used.
  Server(const ServerOptions& options, std::shared_ptr<const Mesh> mesh);
  /// Sends a note to the clients that the server ends.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Returns the port.
  std::uint16_t port() const noexcept { return port_; }

  /// Accepts clients, and reads what has come: at most 32 KB of the controlling client, and 4 KB of
  /// each other one.
  void receive(const Moment& moment);
  /// Runs one cycle of the tool, and sends its results to all clients.
  void tick(const Moment& moment);

  const ServerCounts& counts() const noexcept { return counts_; }
  const CrtkSession& session() const noexcept { return session_; }
  /// Returns true while a mesh that has come is being prepared.
  bool is_preparing() const noexcept { return next_mesh_.valid(); }

 private:
  static constexpr std::size_t most_shown = 256;                        // triangles of a frame
  static constexpr std::size_t most_candidates = std::size_t{1} << 14;  // near the tool

  /// A mesh with its index.
  struct IndexedMesh {
    std::shared_ptr<const Mesh> mesh;
    std::shared_ptr<const SpatialIndex> index;
    std::string warning = {};
  };
  /// Why a message is refused.
  struct Refusal {
    StatusCode code;
    std::string_view name;  // at most 20 bytes
    std::string_view text;
  };

  static IndexedMesh prepared(const Header& header, const ByteList& body,
                              const MotionConstraintSettings& settings);
  void accept_clients();
  void receive_from(Connection& client, std::size_t most, const Moment& moment);
  void judge_header(Connection& client, const Moment& moment);
  void take(Connection& client, const Moment& moment);
  void take_transform(Connection& client, Bytes content, const Moment& moment);
  void take_command(Connection& client, Bytes content, const Moment& moment);
  void take_points(Connection& client, Bytes content, const Moment& moment);
  void fit_registration(Connection& client, const Moment& moment);
  bool takes_control(Connection& client, const Moment& moment);
  void end(Connection& client) noexcept;
  void refuse(Connection& client, const Refusal& refusal, const Moment& moment);
  void exchange_mesh(const Moment& moment);
  void send_transform(const Moment& moment);
  void send_triangles(const Moment& moment);
  void send_state(const Moment& moment);
  void note(StatusCode code, std::string_view name, std::string_view text, const Moment& moment);
  void send_to_all(Outgoing kind);

  ServerOptions options_;
  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const SpatialIndex> index_;
  CrtkSession session_;
  int door_ = -1;
  std::uint16_t port_ = 0;
  std::array<std::unique_ptr<Connection>, most_clients> clients_;
  Connection* controller_ = nullptr;    // the client that controls the tool, if any
  std::future<IndexedMesh> next_mesh_;  // valid while a mesh is being prepared
  std::vector<Vec3> measured_, model_;  // points for a registration [mm]
  ServerCounts counts_;
  ByteList message_;  // the message to send
  CycleStatus sent_status_ = CycleStatus::guarded;
  std::string_view sent_reason_;
  double state_due_ = 0.0;         // when the state is sent in any case [s]
  double triangles_due_ = 0.0;     // when triangles may be sent next [s]
  std::string_view cause_;         // of the last release or refusal; empty: the session's
  Buffer<TriangleId> near_;        // candidates
  std::vector<TriangleId> shown_;  // triangles that the clients have
  std::vector<TriangleId> active_;
  std::vector<Triangle> drawn_;
};

}  // namespace keepout::app::igtl
