// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace keepout {

/// A regular file that any number of threads may read at any offset. It is read and never mapped,
/// so a file that is truncated meanwhile gives an error, not a signal.
class ReadOnlyFile {
 public:
  explicit ReadOnlyFile(const std::filesystem::path& path) noexcept;
  ~ReadOnlyFile();
  ReadOnlyFile(const ReadOnlyFile&) = delete;
  ReadOnlyFile& operator=(const ReadOnlyFile&) = delete;

  bool is_open() const noexcept { return descriptor_ >= 0; }

  /// Returns the size when the file was opened. [bytes]
  std::uint64_t size() const noexcept { return size_; }

  /// Reads `size` bytes from `offset` on. Returns false if the file has too few bytes.
  bool read(std::uint64_t offset, void* to, std::size_t size) const noexcept;

 private:
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace keepout
