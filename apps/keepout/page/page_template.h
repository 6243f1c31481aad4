// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace keepout::app {

// A page without what it is to show, as apps/web/build makes it: one file, with a place for that.

/// The file of a name: in the folder that the environment variable KEEPOUT_WEB names, or in
/// share/keepout/web beside the folder of this program. It need not be there.
std::filesystem::path page_template_file(std::string_view name);

/// The page before and after the place.
struct PageTemplate {
  std::string before, after;
};

/// `place`: the comment that marks it. Throws Error when the file is not there, or has no such
/// place.
PageTemplate read_page_template(const std::filesystem::path& file, std::string_view place);

}  // namespace keepout::app
