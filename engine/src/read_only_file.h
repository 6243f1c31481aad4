// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace keepout {

/// A regular file, open for reading at any place by any number of threads. It is read and never
/// mapped: one that is cut short meanwhile gives an error, not a signal.
class ReadOnlyFile {
 public:
  explicit ReadOnlyFile(const std::filesystem::path& path) noexcept;
  ~ReadOnlyFile();
  ReadOnlyFile(const ReadOnlyFile&) = delete;
  ReadOnlyFile& operator=(const ReadOnlyFile&) = delete;

  bool is_open() const noexcept { return descriptor_ >= 0; }

  /// As it was when opened. [bytes]
  std::uint64_t size() const noexcept { return size_; }

  /// Reads `size` bytes from `offset` on; false if they are not all to be had.
  bool read(std::uint64_t offset, void* to, std::size_t size) const noexcept;

 private:
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace keepout
