// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>

namespace keepout::app {

/// A file that appears only when it is whole: written beside its place under another name, and
/// moved there by commit(). Left without a commit, nothing remains, and what stood there before
/// still stands.
class OutputFile {
 public:
  /// Throws Error when the file cannot be made.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream() noexcept { return stream_; }

  /// Throws Error when something could not be written, a full disk for one.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path partial_;
  std::ofstream stream_;
};

}  // namespace keepout::app
