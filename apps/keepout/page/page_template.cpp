// SPDX-License-Identifier: BSD-3-Clause
#include "page/page_template.h"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <system_error>

#include "keepout/error.h"

namespace keepout::app {
namespace {

constexpr const char* what_to_do =
    "In a checkout of keepout, with npm and a network, ./run makes the pages of reports and ./run "
    "live makes live.html. An installed keepout has the pages that existed at the installation. "
    "For pages in another directory, set the environment variable KEEPOUT_WEB to it";

}  // namespace

std::filesystem::path page_template_file(std::string_view name) {
  const char* named = std::getenv("KEEPOUT_WEB");
  if (named != nullptr && *named != '\0') return std::filesystem::path(named) / name;
  std::error_code none;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", none);
  return program.parent_path().parent_path() / "share/keepout/web" / name;
}

PageTemplate read_page_template(const std::filesystem::path& file, std::string_view place) {
  std::ifstream stream(file, std::ios::binary);
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  if (page.empty()) {
    throw Error("the page's front end is missing: there is no " + file.string() + ". " +
                what_to_do);
  }
  const std::size_t at = page.find(place);
  if (at == std::string::npos || page.find(place, at + 1) != std::string::npos) {
    throw Error(file.string() + ": is not the front end of this keepout, which has one line '" +
                std::string(place) + "'. " + what_to_do);
  }
  return {page.substr(0, at), page.substr(at + place.size())};
}

}  // namespace keepout::app
