// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <fstream>
#include <ostream>

#include "commands.h"
#include "keepout/error.h"
#include "shared/documentation.h"

namespace keepout::app {
namespace {

/// Returns the title of a page: its first line, "# TITLE".
std::string title_of(const std::filesystem::path& page) {
  std::ifstream file(page);
  std::string line;
  std::getline(file, line);
  return line.starts_with("# ") ? line.substr(2) : line;
}

}  // namespace

std::vector<std::string> pages_of_docs() {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(documentation_folder(), error), end;
       !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".md") names.push_back(entry->path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

void docs(const DocsOptions& options, std::ostream& out) {
  const std::filesystem::path folder = documentation_folder();
  if (folder.empty()) {
    throw Error(
        "the documentation is missing: it is installed with the package keepout, and is the folder "
        "docs of the sources, but this program finds neither");
  }
  if (!options.page.empty()) {
    out << (folder / (options.page + ".md")).string() << '\n';
    return;
  }
  out << folder.string() << '\n';
  std::error_code error;
  const std::filesystem::path site = folder.parent_path() / "site/index.html";
  if (std::filesystem::exists(site, error)) out << site.string() << '\n';
  for (const std::string& name : pages_of_docs()) {
    constexpr std::size_t column = 28;
    std::string cell = "  " + name;
    cell.resize(std::max(cell.size() + 1, column), ' ');
    out << cell << title_of(folder / (name + ".md")) << '\n';
  }
}

}  // namespace keepout::app
