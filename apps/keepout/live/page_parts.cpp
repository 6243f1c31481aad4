// SPDX-License-Identifier: BSD-3-Clause
#include "live/page_parts.h"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "keepout/error.h"

namespace keepout::app {
namespace {

constexpr std::string_view place = "<!-- keepout live: the anatomy goes here -->";

constexpr const char* what_to_do =
    "In a checkout of keepout, `./run live` builds it; an installed keepout has it if it was built "
    "before the installation; from elsewhere, name its folder in the environment variable "
    "KEEPOUT_WEB";

}  // namespace

std::filesystem::path page_parts_file() {
  const char* named = std::getenv("KEEPOUT_WEB");
  if (named != nullptr && *named != '\0') return std::filesystem::path(named) / "live.html";
  std::error_code none;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", none);
  return program.parent_path().parent_path() / "share/keepout/web/live.html";
}

PageParts read_page_parts(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  if (page.empty()) {
    throw Error("the page without an anatomy is missing: there is no " + file.string() + ". " +
                what_to_do);
  }
  const std::size_t at = page.find(place);
  if (at == std::string::npos || page.find(place, at + 1) != std::string::npos) {
    throw Error(file.string() + ": is not the page of this keepout, which has one place for the " +
                "anatomy. " + what_to_do);
  }
  return {page.substr(0, at), page.substr(at + place.size())};
}

}  // namespace keepout::app
