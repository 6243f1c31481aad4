// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "serve/connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>

namespace keepout::app {
namespace {

bool is_passing(int error) { return error == EINTR || error == EAGAIN || error == EWOULDBLOCK; }

}  // namespace

Connection::Connection(Service& service, int in, int out, Kind kind)
    : session_(service), in_(in), out_(out), kind_(kind) {}

Connection::~Connection() {
  if (kind_ == Kind::socket && in_ >= 0) ::close(in_);
}

void Connection::receive() {
  const std::span<char> room = session_.room();
  const ssize_t count = kind_ == Kind::socket ? ::recv(in_, room.data(), room.size(), MSG_DONTWAIT)
                                              : ::read(in_, room.data(), room.size());
  if (count > 0) {
    session_.added(static_cast<std::size_t>(count));
  } else if (count == 0) {
    session_.ended();
  } else if (!is_passing(errno)) {
    if (kind_ == Kind::files) trouble_ = std::string("stdin: ") + std::strerror(errno);
    has_gone_ = true;
  }
}

void Connection::serve() {
  if (session_.has_work()) session_.take_turn();
  if (!session_.unsent().empty()) send();
}

void Connection::send() {
  const std::string_view text = session_.unsent();
  if (kind_ == Kind::files && !has_room()) return;
  // A pipe that has room takes as much as PIPE_BUF without waiting.
  const ssize_t count =
      kind_ == Kind::socket
          ? ::send(out_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL)
          : ::write(out_, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
  if (count >= 0) {
    session_.sent(static_cast<std::size_t>(count));
  } else if (errno == EPIPE) {
    reader_gone();
  } else if (!is_passing(errno)) {
    if (kind_ == Kind::files) trouble_ = std::string("stdout: ") + std::strerror(errno);
    has_gone_ = true;
  }
}

bool Connection::has_room() const noexcept {
  pollfd file{out_, POLLOUT, 0};
  return ::poll(&file, 1, 0) == 1;
}

}  // namespace keepout::app
