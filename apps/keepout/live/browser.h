// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace keepout::app {

/// The address of a file, for a browser: its absolute path, with a percent sign and two digits in
/// the place of every byte that means something else in an address.
std::string file_url(const std::filesystem::path& file);

/// Asks the desktop to open an address, and waits for nothing. Whether there is a desktop to ask.
bool open_in_browser(const std::string& url);

}  // namespace keepout::app
