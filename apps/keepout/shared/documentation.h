// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace keepout::app {

/// Returns the folder of the pages of documentation: installed beside this program, or else in the
/// sources that it was built in. Empty if it is in neither.
std::filesystem::path documentation_folder();

/// Returns a text in which each "docs/NAME.md" names the page where it is on this machine.
/// Unchanged without a documentation_folder().
std::string with_places_of_pages(const std::string& text);

}  // namespace keepout::app
