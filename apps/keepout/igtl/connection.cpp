// SPDX-License-Identifier: BSD-3-Clause
#include "igtl/connection.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace keepout::app::igtl {
namespace {

constexpr std::size_t most_waiting = std::size_t{1} << 16;  // [bytes]
constexpr std::size_t most_read = std::size_t{1} << 15;     // at once [bytes]

void set(int file, int level, int option, int value) noexcept {
  ::setsockopt(file, level, option, &value, sizeof value);  // a failure costs only time
}

}  // namespace

Connection::Connection(std::size_t longest_body)
    : stream(longest_body), longest_body_(longest_body), received_(most_read) {
  waiting_.reserve(most_waiting);
}

void Connection::open(int file) {
  close();
  file_ = file;
  stream = MessageStream(longest_body_);
  waiting_.clear();
  was_refused = false;
  set(file, IPPROTO_TCP, TCP_NODELAY, 1);
  // A client that does not read gets few outdated frames once it reads again.
  set(file, SOL_SOCKET, SO_SNDBUF, 1 << 15);
  // A client whose machine has lost its power gives up its control after about 10 s.
  set(file, SOL_SOCKET, SO_KEEPALIVE, 1);
  set(file, IPPROTO_TCP, TCP_KEEPIDLE, 4);
  set(file, IPPROTO_TCP, TCP_KEEPINTVL, 2);
  set(file, IPPROTO_TCP, TCP_KEEPCNT, 3);
}

void Connection::close() noexcept {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

Bytes Connection::receive(std::size_t most) noexcept {
  if (!is_open()) return {};
  const ssize_t count =
      ::recv(file_, received_.data(), std::min(most, received_.size()), MSG_DONTWAIT);
  if (count > 0) return Bytes(received_).first(static_cast<std::size_t>(count));
  const bool has_ended = count == 0 || (errno != EAGAIN && errno != EINTR);
  if (has_ended) close();
  return {};
}

bool Connection::send(Bytes message, Outgoing kind) {
  if (!is_open()) return false;
  if (!waiting_.empty() &&
      (kind == Outgoing::frame || waiting_.size() + message.size() > most_waiting)) {
    return false;
  }
  if (waiting_.empty()) message = message.subspan(write(message));
  waiting_.insert(waiting_.end(), message.begin(), message.end());
  return is_open();
}

void Connection::flush() {
  if (!is_open() || waiting_.empty()) return;
  const auto sent = static_cast<std::ptrdiff_t>(write(waiting_));
  waiting_.erase(waiting_.begin(), waiting_.begin() + sent);
}

std::size_t Connection::write(Bytes bytes) noexcept {
  const ssize_t count = ::send(file_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (count >= 0) return static_cast<std::size_t>(count);
  if (errno != EAGAIN && errno != EINTR) close();
  return 0;
}

}  // namespace keepout::app::igtl
