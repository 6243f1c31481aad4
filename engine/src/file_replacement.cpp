// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "file_replacement.h"

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

}  // namespace

FileReplacement::FileReplacement(const std::filesystem::path& path)
    : path_(path),
      temporary_(temporary_beside(path)),
      file_(temporary_, std::ios::binary | std::ios::trunc) {}

FileReplacement::~FileReplacement() {
  if (committed_) return;
  file_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void FileReplacement::write(const void* bytes, std::size_t size) {
  file_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
}

bool FileReplacement::commit() {
  file_.close();
  if (!file_) return false;
  std::error_code error;
  std::filesystem::rename(temporary_, path_, error);
  committed_ = !error;
  return committed_;
}

}  // namespace keepout
