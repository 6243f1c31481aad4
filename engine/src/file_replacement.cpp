// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/file_replacement.h"

#include <cerrno>
#include <random>
#include <string>

namespace keepout {
namespace {

std::filesystem::path temporary_beside(const std::filesystem::path& path) {
  std::error_code ignored;
  std::random_device random;
  std::filesystem::path temporary = follow_links(path, ignored);
  temporary += std::to_string(random()) + std::to_string(random());
  temporary += ".part";
  return temporary;
}

/// Returns the reason why no file can be put at a path, or no error if there is a regular file or
/// nothing. Replacing a pipe or a device would remove it.
std::errc obstacle_at(const std::filesystem::path& path) {
  if (path.filename().empty()) return std::errc::invalid_argument;
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return {};
  return std::filesystem::is_directory(status) ? std::errc::is_a_directory : std::errc::file_exists;
}

}  // namespace

std::filesystem::path follow_links(std::filesystem::path path, std::error_code& error) {
  constexpr int most_links = 40;
  std::error_code missing;
  for (int links = 0; std::filesystem::is_symlink(path, missing); ++links) {
    if (links == most_links) error = std::make_error_code(std::errc::too_many_symbolic_link_levels);
    if (error) break;
    // An absolute target replaces the whole path.
    path = path.parent_path() / std::filesystem::read_symlink(path, error);
  }
  return path;
}

FileReplacement::FileReplacement(const std::filesystem::path& path)
    : FileReplacement(path, temporary_beside(path)) {}

FileReplacement::FileReplacement(const std::filesystem::path& path,
                                 const std::filesystem::path& temporary)
    : path_(follow_links(path, error_)), temporary_(temporary) {
  if (!error_) error_ = std::make_error_code(obstacle_at(path_));
  if (error_) return;
  errno = 0;
  file_.open(temporary_, std::ios::binary | std::ios::trunc);
  note_failure();
}

FileReplacement::~FileReplacement() {
  if (is_committed_) return;
  file_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void FileReplacement::write(const void* bytes, std::size_t size) {
  errno = 0;
  file_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  note_failure();
}

std::error_code FileReplacement::finish() {
  errno = 0;
  if (file_.is_open()) file_.close();
  note_failure();
  return error_;
}

std::error_code FileReplacement::commit() {
  if (is_committed_ || finish()) return error_;
  std::filesystem::rename(temporary_, path_, error_);
  is_committed_ = !error_;
  return error_;
}

void FileReplacement::note_failure() {
  if (file_ || error_) return;
  // Streams give no cause of a failure, but errno has that of the last system call.
  error_ = errno != 0 ? std::error_code(errno, std::generic_category())
                      : std::make_error_code(std::errc::io_error);
}

}  // namespace keepout
