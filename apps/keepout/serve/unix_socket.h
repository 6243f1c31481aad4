// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <filesystem>

namespace keepout::app {

/// A Unix socket that clients connect to: its file is there, for its owner alone (0600), as long as
/// this object.
class UnixSocket {
 public:
  /// What a server that has gone has left behind is replaced. Throws Error when another one
  /// answers there, when something else than a socket stands there, when the path is too long, and
  /// when the file cannot be made.
  explicit UnixSocket(std::filesystem::path path);
  ~UnixSocket();
  UnixSocket(const UnixSocket&) = delete;
  UnixSocket& operator=(const UnixSocket&) = delete;

  /// Readable when a client waits.
  int file() const noexcept { return file_; }

  /// The next client, for the caller to close; -1 if there is none, or if none can be taken now.
  /// `is_out_of_files`: the client is still waiting, since there is no room for another open file.
  int accept(bool& is_out_of_files) noexcept;

 private:
  std::filesystem::path path_;
  int file_ = -1;
  dev_t device_ = 0;  // of the socket's file, which somebody else may have replaced
  ino_t inode_ = 0;
};

}  // namespace keepout::app
