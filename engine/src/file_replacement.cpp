// SPDX-License-Identifier: BSD-3-Clause
#include "file_replacement.h"

#include <cerrno>
#include <random>
#include <string>

namespace keepout {
namespace {

std::filesystem::path temporary_beside(const std::filesystem::path& path) {
  std::random_device random;
  std::filesystem::path temporary = path;
  temporary += std::to_string(random()) + std::to_string(random());
  temporary += ".part";
  return temporary;
}

/// Why no file can be put there: a pipe or a device would be gone, and with it what others know by
/// its name. No error if there is a file, or nothing.
std::errc obstacle_at(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return {};
  return std::filesystem::is_directory(status) ? std::errc::is_a_directory : std::errc::file_exists;
}

}  // namespace

FileReplacement::FileReplacement(const std::filesystem::path& path)
    : path_(path), temporary_(temporary_beside(path)) {
  if (const std::errc error = obstacle_at(path); error != std::errc{}) {
    error_ = std::make_error_code(error);
    return;
  }
  errno = 0;
  file_.open(temporary_, std::ios::binary | std::ios::trunc);
  note_failure();
}

FileReplacement::~FileReplacement() {
  if (committed_) return;
  file_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void FileReplacement::write(const void* bytes, std::size_t size) {
  errno = 0;
  file_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  note_failure();
}

std::error_code FileReplacement::commit() {
  errno = 0;
  file_.close();
  note_failure();
  if (error_) return error_;
  std::filesystem::rename(temporary_, path_, error_);
  committed_ = !error_;
  return error_;
}

void FileReplacement::note_failure() {
  if (file_ || error_) return;
  // Streams do not say why, but the system that they asked last did.
  error_ = errno != 0 ? std::error_code(errno, std::generic_category())
                      : std::make_error_code(std::errc::io_error);
}

}  // namespace keepout
