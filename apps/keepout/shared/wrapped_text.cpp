// SPDX-License-Identifier: BSD-3-Clause
#include "shared/wrapped_text.h"

#include <cstddef>
#include <ostream>
#include <sstream>

namespace keepout::app {
namespace {

/// Not bytes: our texts are in UTF-8.
std::size_t characters_in(const std::string& word) {
  std::size_t width = 0;
  for (const char c : word) width += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return width;
}

}  // namespace

void print_wrapped(std::ostream& out, const Json& text) {
  constexpr std::size_t longest = 88;
  if (text.is_array()) {
    for (const Json& one : text) print_wrapped(out, one);
    return;
  }
  std::istringstream words(text.get<std::string>());
  std::size_t width = 0;
  for (std::string word; words >> word;) {
    const std::size_t more = characters_in(word);
    if (width > 0) {
      const bool fits = width + 1 + more <= longest;
      out << (fits ? ' ' : '\n');
      width = fits ? width + 1 : 0;
    }
    out << word;
    width += more;
  }
  out << '\n';
}

}  // namespace keepout::app
