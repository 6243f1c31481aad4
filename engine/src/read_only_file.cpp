// SPDX-License-Identifier: BSD-3-Clause
#include "read_only_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace keepout {

ReadOnlyFile::ReadOnlyFile(const std::filesystem::path& path) noexcept
    // Without O_NONBLOCK, opening a pipe would wait for a writer.
    : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  struct stat status;
  if (descriptor_ >= 0 && fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode)) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    return;
  }
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
}

ReadOnlyFile::~ReadOnlyFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

bool ReadOnlyFile::read(std::uint64_t offset, void* to, std::size_t size) const noexcept {
  auto* place = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t got = pread(descriptor_, place, size, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    offset += static_cast<std::uint64_t>(got);
    place += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace keepout
