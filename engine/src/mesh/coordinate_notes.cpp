// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "mesh_file.h"

namespace keepout {
namespace {

constexpr char upper(char c) noexcept {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

constexpr bool is_of_a_word(char c) noexcept {
  return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

void skip_blanks(std::string_view& text) noexcept {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
}

/// Removes a word from the start of the text, with the blanks around it. Returns false if the text
/// does not begin with the word.
bool take(std::string_view& text, std::string_view word) noexcept {
  skip_blanks(text);
  if (!text.starts_with(word)) return false;
  text.remove_prefix(word.size());
  skip_blanks(text);
  return true;
}

/// Calls read(rest) with the text after each place where a word begins with `word`.
template <class Read>
void for_each_begin(std::string_view text, std::string_view word, const Read& read) {
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string_view::npos;) {
    const bool begins = at == 0 || !is_of_a_word(text[at - 1]);
    at += word.size();
    if (begins) read(text.substr(at));
  }
}

/// Returns true for three letters, one of each pair of directions: RAS, LPS, LAS, RPI, ...
bool is_orientation(std::string_view word) noexcept {
  constexpr std::array<std::string_view, 3> pairs{"RL", "AP", "SI"};
  return word.size() == 3 && std::all_of(pairs.begin(), pairs.end(), [&](std::string_view pair) {
           return word.find_first_of(pair) != std::string_view::npos;
         });
}

/// Returns a space in the letters that NRRD uses: LPS for LEFT-POSTERIOR-SUPERIOR.
std::string abbreviated(std::string_view value) {
  if (value.find('-') == std::string_view::npos) return std::string(value);
  std::string initials;
  bool begins = true;
  for (const char c : value) {
    if (begins) initials += c;
    begins = c == '-';
  }
  return initials;
}

void read_space(std::string_view after_space, CoordinateNotes& notes) {
  if (!take(after_space, "=")) return;
  const auto end = std::find_if_not(after_space.begin(), after_space.end(), is_of_a_word);
  const auto size = static_cast<std::size_t>(end - after_space.begin());
  const std::string orientation = abbreviated(after_space.substr(0, size));
  if (!is_orientation(orientation)) return;
  if (notes.space.empty()) notes.space = orientation;
  if (notes.space != orientation) notes.contradiction = notes.space + " and " + orientation;
}

void read_unit(std::string_view after_one, CoordinateNotes& notes) {
  if (!take(after_one, "UNIT") || !take(after_one, "=")) return;
  double value = 0.0;
  const char* const text_end = after_one.data() + after_one.size();
  const auto [end, error] = std::from_chars(after_one.data(), text_end, value);
  if (error != std::errc{} || !std::isfinite(value) || value <= 0.0) return;
  after_one.remove_prefix(static_cast<std::size_t>(end - after_one.data()));
  if (take(after_one, "MM")) notes.millimetres = value;
}

}  // namespace

CoordinateNotes notes_of(const std::vector<std::string>& comments) {
  CoordinateNotes notes;
  for (std::string comment : comments) {
    std::transform(comment.begin(), comment.end(), comment.begin(), upper);
    for_each_begin(comment, "SPACE", [&](std::string_view rest) { read_space(rest, notes); });
    for_each_begin(comment, "1", [&](std::string_view rest) { read_unit(rest, notes); });
  }
  return notes;
}

}  // namespace keepout
