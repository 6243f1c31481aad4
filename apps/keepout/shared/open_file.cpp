// SPDX-License-Identifier: BSD-3-Clause
#include "shared/open_file.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <iostream>
#include <string>

namespace keepout::app {
namespace {

namespace fs = std::filesystem;

/// Returns the descriptor number of an entry that belongs to this process; -1 for every other
/// entry.
int own_descriptor(const fs::path& entry) {
  const std::string own = "/proc/" + std::to_string(::getpid()) + "/";
  if (!entry.string().starts_with(own)) return -1;
  const std::string name = entry.filename().string();
  int number = -1;
  const char* const last = name.data() + name.size();
  return std::from_chars(name.data(), last, number).ptr == last ? number : -1;
}

std::error_code last_error() { return {errno, std::generic_category()}; }

}  // namespace

std::optional<fs::path> entry_of_open_file(const fs::path& path) {
  constexpr int most_links = 40;
  fs::path at = path == "-" ? "/dev/stdout" : path;
  std::error_code none;
  for (int links = 0; links < most_links; ++links) {
    const fs::path folder = fs::weakly_canonical(fs::absolute(at, none).parent_path(), none);
    if (folder.filename() == "fd" && folder.string().starts_with("/proc/")) {
      return folder / at.filename();
    }
    if (!fs::is_symlink(at, none)) break;
    at = at.parent_path() / fs::read_symlink(at, none);
  }
  return std::nullopt;
}

OpenFile::OpenFile(const fs::path& entry) {
  const int own = own_descriptor(entry);
  if (own < 0) {
    descriptor_ = ::open(entry.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NOCTTY);
  } else if (const int flags = ::fcntl(own, F_GETFL); flags >= 0) {
    errno = EBADF;  // the file is open for reading only
    // Duplicated, not opened anew: the copy shares its position with the other writers of the file.
    if ((flags & O_ACCMODE) != O_RDONLY) descriptor_ = ::fcntl(own, F_DUPFD_CLOEXEC, 0);
  }
  if (descriptor_ < 0) {
    error_ = last_error();
  } else if (own == STDOUT_FILENO) {
    std::cout.flush();
    ::dup2(STDERR_FILENO, STDOUT_FILENO);
  }
}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::error_code OpenFile::write(std::string_view text) noexcept {
  while (!text.empty() && !error_) {
    const ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written >= 0) {
      text.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EAGAIN) {  // another process has made the file non-blocking
      struct pollfd ready = {.fd = descriptor_, .events = POLLOUT, .revents = 0};
      ::poll(&ready, 1, -1);
    } else if (errno != EINTR) {
      error_ = last_error();
    }
  }
  return error_;
}

}  // namespace keepout::app
