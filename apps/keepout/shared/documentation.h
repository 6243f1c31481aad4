// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace keepout::app {

/// Returns the directory of the documentation pages: installed beside this program, or in the
/// sources that the program was built in. Empty if it is in neither.
std::filesystem::path documentation_folder();

/// Returns the text with each "docs/NAME.md" replaced by the path of that page on this machine.
/// Returns it unchanged without a documentation_folder().
std::string with_places_of_pages(const std::string& text);

}  // namespace keepout::app
