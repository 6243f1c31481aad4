// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "serve/server.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <list>
#include <ostream>
#include <string>
#include <vector>

#include "serve/answer.h"
#include "serve/connection.h"

namespace keepout::app {
namespace {

constexpr short gone = POLLERR | POLLHUP | POLLNVAL;
constexpr int for_ever = -1;

/// What is waited for, in the same memory each time.
class Waiting {
 public:
  void clear() noexcept { files_.clear(); }
  void add(int file, short events) { files_.push_back({file, events, 0}); }  // -1: not waited for

  /// Two places.
  void add(const Connection& connection) {
    add(connection.input(), POLLIN);
    add(connection.output(), connection.wants_room() ? POLLOUT : short{0});
  }

  void wait(int milliseconds) noexcept {
    if (::poll(files_.data(), files_.size(), milliseconds) >= 0) return;
    for (pollfd& file : files_) file.revents = 0;  // interrupted
  }

  short what_happened(std::size_t place) const noexcept { return files_[place].revents; }

  /// What was waited for at the two places of a connection.
  void serve(Connection& connection, std::size_t place) const {
    if (what_happened(place + 1) & gone) {
      connection.reader_gone();
      return;
    }
    if (what_happened(place) != 0) connection.receive();
    connection.serve();
  }

 private:
  std::vector<pollfd> files_;
};

/// Clients of a socket, and who waits at the door.
class Clients {
 public:
  Clients(Service& service, UnixSocket& socket, std::size_t most)
      : service_(service), socket_(socket), most_(most) {}

  void add_to(Waiting& waiting) const {
    waiting.add(is_out_of_files_ ? -1 : socket_.file(), POLLIN);
    for (const Connection& connection : connections_) waiting.add(connection);
  }

  /// How long nothing need be done, if nothing happens.
  int patience() const noexcept {
    const bool has_work = std::any_of(connections_.begin(), connections_.end(),
                                      [](const Connection& c) { return c.has_work(); });
    // Without room for another open file, the door is tried again from time to time.
    return has_work ? 0 : is_out_of_files_ ? 100 : for_ever;
  }

  /// `door`: the place from which on add_to() has added.
  void serve(const Waiting& waiting, std::size_t door) {
    std::size_t count = 1;
    for (Connection& connection : connections_) {
      waiting.serve(connection, door + count);
      count += 2;
    }
    connections_.remove_if([](const Connection& c) { return c.is_done(); });
    if (is_out_of_files_ || waiting.what_happened(door) != 0) admit();
  }

 private:
  void admit() {
    for (int i = 0; i < 8; ++i) {  // at a time, so that nobody who is in waits for long
      const int client = socket_.accept(is_out_of_files_);
      if (client < 0) return;
      if (connections_.size() < most_) {
        connections_.emplace_back(service_, client, client, Connection::Kind::socket);
      } else {
        turn_away(client);
      }
    }
  }

  void turn_away(int client) const {
    std::string out;
    append_error(out, "null", "too_many_clients",
                 "there are " + std::to_string(most_) +
                     " clients already: close one, or start with a larger --max-clients");
    // A new socket has room for it.
    [[maybe_unused]] const ssize_t sent =
        ::send(client, out.data(), out.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    ::close(client);
  }

  Service& service_;
  UnixSocket& socket_;
  std::size_t most_;
  std::list<Connection> connections_;
  bool is_out_of_files_ = false;
};

}  // namespace

int serve_stdio(Service& service, const StopSignal& stop, std::ostream& log) {
  Connection connection(service, STDIN_FILENO, STDOUT_FILENO, Connection::Kind::files);
  Waiting waiting;
  while (!connection.is_done()) {
    waiting.clear();
    waiting.add(stop.file(), POLLIN);
    waiting.add(connection);
    waiting.wait(connection.has_work() ? 0 : for_ever);
    if (waiting.what_happened(0) != 0) return EXIT_SUCCESS;
    waiting.serve(connection, 1);
  }
  if (connection.trouble().empty()) return EXIT_SUCCESS;
  log << "keepout: " << connection.trouble() << '\n';
  return EXIT_FAILURE;
}

int serve_socket(Service& service, const StopSignal& stop, UnixSocket& socket,
                 std::size_t most_clients) {
  Clients clients(service, socket, most_clients);
  Waiting waiting;
  while (true) {
    waiting.clear();
    waiting.add(stop.file(), POLLIN);
    clients.add_to(waiting);
    waiting.wait(clients.patience());
    if (waiting.what_happened(0) != 0) return EXIT_SUCCESS;
    clients.serve(waiting, 1);
  }
}

}  // namespace keepout::app
