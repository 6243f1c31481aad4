// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>

namespace keepout {

/// A file that appears whole or not at all: written beside its place under a name that no other
/// writer will choose, then renamed.
class FileReplacement {
 public:
  explicit FileReplacement(const std::filesystem::path& path);
  /// Without a commit nothing is left.
  ~FileReplacement();
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;

  void write(const void* bytes, std::size_t size);

  /// Puts the file into its place; false if that, or anything written before, failed.
  bool commit();

 private:
  std::filesystem::path path_, temporary_;
  std::ofstream file_;
  bool committed_ = false;
};

}  // namespace keepout
