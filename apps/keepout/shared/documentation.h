// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace keepout::app {

/// Returns the directory of the documentation pages. They are installed beside this program, or in
/// the source tree that contains the build directory. Empty if they are in neither.
std::filesystem::path documentation_folder();

/// Returns the text with each "docs/NAME.md" replaced by the path of that page on this machine.
/// Returns the text unchanged if documentation_folder() is empty, or if it is "docs" in the present
/// directory.
std::string with_places_of_pages(const std::string& text);

}  // namespace keepout::app
