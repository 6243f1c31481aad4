// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace keepout::app {

// The page without an anatomy, as apps/web/build makes it: one file, with a place for the anatomy.

/// The file: in the folder that the environment variable KEEPOUT_WEB names, or in
/// share/keepout/web beside the folder of this program.
std::filesystem::path page_parts_file();

/// The page before and after the place for the anatomy.
struct PageParts {
  std::string before, after;
};

/// Throws Error when the file is not there, or has no such place.
PageParts read_page_parts(const std::filesystem::path& file);

}  // namespace keepout::app
