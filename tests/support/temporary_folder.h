// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdlib.h>

#include <stdexcept>
#include <string_view>

#include "messages.h"

namespace keepout {

/// A new folder for one test; removed with this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = testing::TempDir() + "keepout_XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }

  /// Writes a file into the folder, and replaces a file of that name.
  std::filesystem::path write(std::string_view name, std::string_view contents) const {
    const std::filesystem::path file = path_ / name;
    std::ofstream(file, std::ios::binary).write(contents.data(), std::ssize(contents));
    return file;
  }

  std::string contents(std::string_view name) const { return contents_of(path_ / name); }

 private:
  std::filesystem::path path_;
};

}  // namespace keepout
