// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace keepout::app {

// A page without its data, as apps/web/build makes it: one file, with a mark for the data.

/// Returns the file of a template: in the directory that the environment variable KEEPOUT_WEB
/// names, or in share/keepout/web beside this program's directory. The file may be missing.
std::filesystem::path page_template_file(std::string_view name);

/// The page before and after the mark.
struct PageTemplate {
  std::string before, after;
};

/// Reads a template. `place`: the comment that marks the data. Throws Error if the file is missing
/// or does not have exactly one such comment.
PageTemplate read_page_template(const std::filesystem::path& file, std::string_view place);

}  // namespace keepout::app
