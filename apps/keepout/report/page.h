// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string_view>

namespace keepout::app {

/// The frame of every page: all up to its content, and all after. The page needs nothing but
/// itself. `more_style`: CSS after that of all pages.
void open_page(std::ostream& out, std::string_view title, std::string_view more_style);
void close_page(std::ostream& out);

/// The title of a section, and what to see in it. The title is HTML, the lead plain text.
void open_section(std::ostream& out, std::string_view title, std::string_view lead);

}  // namespace keepout::app
