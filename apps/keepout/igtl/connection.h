// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "igtl/stream.h"

namespace keepout::app::igtl {

/// The kind of an outgoing message: a frame is outdated by the next one, a note is not.
enum class Outgoing : std::uint8_t { frame, note };

/// The connection to one client, on a socket that never blocks. A client that does not read loses
/// frames, and notes once 64 KB wait for it. After construction only stored bodies allocate.
class Connection {
 public:
  explicit Connection(std::size_t longest_body);
  ~Connection() { close(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Begins a connection on a connected socket, which this object closes.
  void open(int file);
  /// Ends the connection. Its counts stay until the next one.
  void close() noexcept;
  /// Returns true if there is a connection.
  bool is_open() const noexcept { return file_ >= 0; }

  /// Returns received bytes, at most as many as `most`; none if no bytes have come. Closes the
  /// connection if the client has ended it. The view is valid until the next call.
  Bytes receive(std::size_t most) noexcept;

  /// Sends a message, or the beginning of it; the rest waits. Returns false if the message was
  /// dropped, or the connection has ended.
  bool send(Bytes message, Outgoing kind);
  /// Sends what waits.
  void flush();

  MessageStream stream;      // of the received bytes
  bool was_refused = false;  // a message in this cycle, which got an answer

 private:
  /// Returns how many bytes the system took. Closes the connection on an error.
  std::size_t write(Bytes bytes) noexcept;

  std::size_t longest_body_;
  int file_ = -1;
  ByteList received_;
  ByteList waiting_;
};

}  // namespace keepout::app::igtl
