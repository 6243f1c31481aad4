// SPDX-License-Identifier: BSD-3-Clause
#include "xml_bounds.h"

#include <string>

#include "keepout/error.h"

namespace keepout {
namespace {

constexpr std::size_t most_bytes_of_tag = 2048;
constexpr std::size_t most_tags = 200'000;
constexpr int deepest = 64;
constexpr std::size_t nowhere = std::string_view::npos;

/// Returns the end of the tag that `text` begins with: its '>', outside of quotes.
std::size_t end_of_tag(std::string_view text) {
  char quote = 0;
  for (std::size_t i = 1; i < text.size() && i < most_bytes_of_tag && text[i] != '<'; ++i) {
    const char c = text[i];
    if (quote == 0 && c == '>') return i;
    if (quote == 0 && (c == '"' || c == '\'')) {
      quote = c;
    } else if (c == quote) {
      quote = 0;
    }
  }
  return nowhere;
}

/// Returns the change of depth by a tag.
int levels(std::string_view tag) {
  if (tag.starts_with("</")) return -1;
  return tag.starts_with("<!") || tag.starts_with("<?") || tag.ends_with("/>") ? 0 : 1;
}

}  // namespace

void require_bounded_xml(std::string_view text) {
  if (text.size() > most_bytes_of_urdf) throw Error("larger than 16 MiB, which no URDF is");
  if (text.find('\0') != nowhere) throw Error("not XML: it holds a zero byte; write UTF-8");
  int depth = 0;
  std::size_t tags = 0;
  for (std::size_t at = text.find('<'); at != nowhere; at = text.find('<', at)) {
    const std::string_view rest = text.substr(at);
    std::size_t end = nowhere;
    if (rest.starts_with("<!--")) {
      end = rest.find("-->", 4);
    } else if (rest.starts_with("<![CDATA[")) {
      end = rest.find("]]>", 9);
    } else if ((end = end_of_tag(rest)) != nowhere) {
      depth += levels(rest.substr(0, end + 1));
    }
    if (end == nowhere || depth < 0) {
      throw Error("not XML: '" + std::string(rest.substr(0, 40)) +
                  "' has no end, no beginning, or " + "is longer than " +
                  std::to_string(most_bytes_of_tag) + " bytes; repair it there");
    }
    if (depth > deepest) throw Error("nested too deep for a URDF: remove what is not the robot");
    if (++tags > most_tags) throw Error("too many elements for a URDF: leave out all but the arm");
    at += end;
  }
}

}  // namespace keepout
