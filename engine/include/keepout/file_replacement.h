// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>
#include <system_error>

namespace keepout {

/// Returns the path after all symbolic links. The file need not exist. Sets `error` if the links
/// form a loop.
std::filesystem::path follow_links(std::filesystem::path path, std::error_code& error);

/// Replaces a file completely or not at all: writes a temporary file in the same directory, then
/// renames it. If the path is a symbolic link, the file that the link points to is replaced.
class FileReplacement {
 public:
  /// Opens a temporary file with a random name. Does not replace a directory, a pipe or a device:
  /// see error().
  explicit FileReplacement(const std::filesystem::path& path);
  /// Opens the given temporary file, which must be in the same directory.
  FileReplacement(const std::filesystem::path& path, const std::filesystem::path& temporary);
  /// Removes the temporary file if it was not committed.
  ~FileReplacement();
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;

  /// Returns the stream for formatted text.
  std::ostream& stream() noexcept { return file_; }
  /// Appends bytes.
  void write(const void* bytes, std::size_t size);

  /// Returns the first failure so far.
  const std::error_code& error() const noexcept { return error_; }

  /// Ends the writing, and returns the first failure. If several files belong together, call
  /// finish() for all before commit() for any.
  std::error_code finish();

  /// Finishes, and renames the temporary file to the path. Returns the first failure.
  std::error_code commit();

 private:
  void note_failure();

  std::error_code error_ = {};
  std::filesystem::path path_;  // after all links
  std::filesystem::path temporary_;
  std::ofstream file_;
  bool is_committed_ = false;
};

}  // namespace keepout
