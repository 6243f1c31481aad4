// SPDX-License-Identifier: BSD-3-Clause
#include "report/page.h"

#include <ostream>

#include "report/page_style.h"
#include "report/text.h"

namespace keepout::app {

void open_page(std::ostream& out, std::string_view title, std::string_view more_style) {
  out << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      << "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      << "<title>" << escape(title) << "</title>\n"
      << "<style>" << page_style << more_style << "</style>\n</head>\n<body>\n<main>\n";
}

void close_page(std::ostream& out) { out << "</main>\n</body>\n</html>\n"; }

void open_section(std::ostream& out, std::string_view title, std::string_view lead) {
  out << "<h2>" << title << "</h2>\n<p class=\"lead\">" << escape(lead) << "</p>\n";
}

}  // namespace keepout::app
