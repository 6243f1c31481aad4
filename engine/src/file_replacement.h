// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <system_error>

namespace keepout {

/// A file that appears whole or not at all: written beside its place under a name that no other
/// writer will choose, then renamed.
class FileReplacement {
 public:
  /// A folder, a pipe or a device is not replaced; commit() tells of it.
  explicit FileReplacement(const std::filesystem::path& path);
  /// Without a commit nothing is left.
  ~FileReplacement();
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;

  void write(const void* bytes, std::size_t size);

  /// Puts the file into its place. No error if that, and all that was written before, succeeded.
  std::error_code commit();

 private:
  void note_failure();

  std::filesystem::path path_, temporary_;
  std::ofstream file_;
  std::error_code error_ = {};  // the first
  bool committed_ = false;
};

}  // namespace keepout
