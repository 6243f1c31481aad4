// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <optional>
#include <string>

#include "igtl/stream.h"
#include "keepout/error.h"

namespace keepout::test::igtl {

using namespace app::igtl;

/// A client that can send any bytes.
class RawPeer {
 public:
  struct Message {
    Header header;
    ByteList body;

    std::uint16_t code() const { return Reader(body).number<std::uint16_t>(); }
    std::string name() const { return reinterpret_cast<const char*>(body.data() + 10); }
    std::string text() const { return reinterpret_cast<const char*>(body.data() + 30); }
  };

  explicit RawPeer(std::uint16_t port) : file_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to = {};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{20, 0};
    ::setsockopt(file_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (::connect(file_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
      throw Error("cannot connect");
    }
  }
  ~RawPeer() { close(); }
  RawPeer(const RawPeer&) = delete;
  RawPeer& operator=(const RawPeer&) = delete;

  void close() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }

  /// Sends bytes; returns how many the system took. `flags`: for example MSG_DONTWAIT.
  std::size_t send(Bytes bytes, int flags = 0) {
    const ssize_t count = ::send(file_, bytes.data(), bytes.size(), flags | MSG_NOSIGNAL);
    return count < 0 ? 0 : static_cast<std::size_t>(count);
  }

  /// Returns the next message; empty if the server has ended the connection.
  std::optional<Message> receive() {
    while (true) {
      const MessageStream::Event event = stream_.next(rest_);
      if (event == MessageStream::Event::header) stream_.store_body();
      if (event == MessageStream::Event::message) {
        EXPECT_TRUE(stream_.is_intact());
        return Message{stream_.header(), stream_.take_body()};
      }
      if (event == MessageStream::Event::broken) throw Error("a broken message");
      if (event != MessageStream::Event::needs_more) continue;
      const ssize_t count = ::recv(file_, received_.data(), received_.size(), 0);
      if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) throw Error("no message came");
      if (count <= 0) return std::nullopt;
      rest_ = Bytes(received_).first(static_cast<std::size_t>(count));
    }
  }

  /// Returns the next message of this device, and skips others.
  Message receive(std::string_view device) {
    while (auto message = receive()) {
      if (message->header.device_name() == device) return *message;
    }
    throw Error("the connection ended");
  }

 private:
  int file_;
  MessageStream stream_{std::size_t{1} << 26};
  std::array<std::uint8_t, 4096> received_;
  Bytes rest_;
};

}  // namespace keepout::test::igtl
