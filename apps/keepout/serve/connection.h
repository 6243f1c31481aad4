// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "serve/session.h"

namespace keepout::app {

/// A session, and the open files that its bytes come from and go to. Never waits.
class Connection {
 public:
  enum class Kind : std::uint8_t {
    files,  // such as stdin and stdout: they stay open, and blocking, since others may share them
    socket  // one socket for both, which is closed at the end
  };
  Connection(Service& service, int in, int out, Kind kind);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// To wait for bytes on, if any are wanted; else -1.
  int input() const noexcept { return !has_gone_ && session_.wants_bytes() ? in_ : -1; }

  /// To wait on: for a reader who has gone, and, if there is something unsent, for room.
  int output() const noexcept { return out_; }
  bool wants_room() const noexcept { return !session_.unsent().empty(); }

  bool has_work() const noexcept { return session_.has_work(); }

  void receive();                                    // there are bytes, or the end of them
  void serve();                                      // one turn: answers, sends what can be sent
  void reader_gone() noexcept { has_gone_ = true; }  // nobody will read an answer
  bool is_done() const noexcept { return has_gone_ || session_.is_done(); }

  /// What went wrong with the files; empty if nothing did, or if the client just left.
  const std::string& trouble() const noexcept { return trouble_; }

 private:
  void send();
  bool has_room() const noexcept;

  Session session_;
  int in_;
  int out_;
  Kind kind_;
  bool has_gone_ = false;
  std::string trouble_;
};

}  // namespace keepout::app
