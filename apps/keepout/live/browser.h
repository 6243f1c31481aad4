// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace keepout::app {

/// Returns the address of a file for a browser: its absolute path. Every byte with a special
/// meaning in an address is replaced by a percent sign and two digits.
std::string file_url(const std::filesystem::path& file);

/// Asks the desktop to open an address, and does not wait. Returns false if there is no desktop.
bool open_in_browser(const std::string& url);

}  // namespace keepout::app
