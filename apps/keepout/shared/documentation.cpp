// SPDX-License-Identifier: BSD-3-Clause
#include "shared/documentation.h"

#include <regex>
#include <system_error>

namespace keepout::app {

namespace fs = std::filesystem;

fs::path documentation_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = program.parent_path().parent_path() / "share/doc/keepout/docs";
  if (fs::exists(installed, error)) return installed;
  for (fs::path folder = program; folder.has_relative_path(); folder = folder.parent_path()) {
    if (fs::exists(folder / "docs/getting_started.md", error)) return folder / "docs";
  }
  return {};
}

std::string with_places_of_pages(const std::string& text) {
  std::error_code error;
  const fs::path folder = documentation_folder();
  if (folder.empty() || folder == fs::current_path(error) / "docs") return text;
  static const std::regex page("docs/([a-z_-]+\\.md)");
  return std::regex_replace(text, page, (folder / "$1").string());
}

}  // namespace keepout::app
