// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>
#include <system_error>

namespace keepout {

/// Follows all links of a path, also where its end does not exist yet. Sets `error` if they lead in
/// a circle.
std::filesystem::path follow_links(std::filesystem::path path, std::error_code& error);

/// A file that appears whole or not at all: written beside its place under another name, then
/// renamed. A link is followed: the file that it points to is replaced, the link stays.
class FileReplacement {
 public:
  /// Writes under a random name. Refuses to replace a directory, a pipe or a device: see error().
  explicit FileReplacement(const std::filesystem::path& path);
  /// Writes under a name that the caller chooses, in the same directory.
  FileReplacement(const std::filesystem::path& path, const std::filesystem::path& temporary);
  /// Removes what was not committed.
  ~FileReplacement();
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;

  /// Accepts formatted text.
  std::ostream& stream() noexcept { return file_; }
  /// Appends bytes.
  void write(const void* bytes, std::size_t size);

  /// The first failure so far.
  const std::error_code& error() const noexcept { return error_; }

  /// Ends the writing, and returns the first failure. Of several files that belong together,
  /// finish() all before the commit() of any.
  std::error_code finish();

  /// Finishes, and moves the file to its place. Returns the first failure.
  std::error_code commit();

 private:
  void note_failure();

  std::error_code error_ = {};
  std::filesystem::path path_;  // links followed
  std::filesystem::path temporary_;
  std::ofstream file_;
  bool is_committed_ = false;
};

}  // namespace keepout
