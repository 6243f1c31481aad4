// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

namespace keepout::app {

/// Returns the entry in /proc of the open file that a path refers to: /dev/stdout, /dev/fd/3, a
/// link to one of these, or "-", which is stdout. Empty for every other path.
std::optional<std::filesystem::path> entry_of_open_file(const std::filesystem::path& path);

/// A file, a pipe or a terminal that is already open, to which results are appended.
class OpenFile {
 public:
  /// Takes an entry from entry_of_open_file(). If it is stdout, only results go there: other text
  /// that the command prints on stdout goes to stderr from then on. Check error() afterwards.
  explicit OpenFile(const std::filesystem::path& entry);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  /// Returns why results cannot be written there; no error if they can.
  const std::error_code& error() const noexcept { return error_; }

  /// Appends a text. Returns why it could not be written completely; no error if it was.
  std::error_code write(std::string_view text) noexcept;

 private:
  int descriptor_ = -1;
  std::error_code error_ = {};
};

}  // namespace keepout::app
