// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "coordinate_notes.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace keepout {
namespace {

constexpr char lower(char c) noexcept {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

constexpr bool is_blank(char c) noexcept { return c == ' ' || c == '\t'; }

constexpr bool is_word(char c) noexcept {
  return (lower(c) >= 'a' && lower(c) <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

void skip_blanks(std::string_view& text) noexcept {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
}

/// Takes a word off the text, in any case; false, and nothing taken, when it is not there.
bool take(std::string_view& text, std::string_view word) noexcept {
  if (text.size() < word.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (lower(text[i]) != word[i]) return false;
  }
  text.remove_prefix(word.size());
  return true;
}

/// The first place from `from` on where a word begins, in any case.
std::size_t find_word(std::string_view text, std::string_view word, std::size_t from) noexcept {
  for (std::size_t at = from; at + word.size() <= text.size(); ++at) {
    std::string_view rest = text.substr(at);
    if ((at == 0 || !is_word(text[at - 1])) && take(rest, word)) return at;
  }
  return std::string_view::npos;
}

/// Three letters, one of each pair of directions: RAS, LPS, LAS, RPI, ...
bool is_orientation(std::string_view word) noexcept {
  constexpr std::array<std::string_view, 3> pairs{"RL", "AP", "SI"};
  return word.size() == 3 && std::all_of(pairs.begin(), pairs.end(), [&](std::string_view pair) {
           return word.find_first_of(pair) != std::string_view::npos;
         });
}

/// In the letters that NRRD abbreviates its names to: left-posterior-superior is LPS.
std::string abbreviated(std::string_view value) {
  std::string initials, whole;
  bool begins = true;
  for (const char c : value) {
    const char letter =
        lower(c) >= 'a' && lower(c) <= 'z' ? static_cast<char>(lower(c) - 'a' + 'A') : c;
    whole += letter;
    if (begins) initials += letter;
    begins = c == '-';
  }
  return value.find('-') != std::string_view::npos ? initials : whole;
}

void note_space(std::string_view orientation, CoordinateNotes& notes) {
  const std::string_view known =
      notes.other_space.empty()
          ? (notes.space == AnatomicalSpace::unstated ? std::string_view() : name(notes.space))
          : std::string_view(notes.other_space);
  if (!known.empty() && known != orientation) {
    notes.contradiction = std::string(known) + " and " + std::string(orientation);
  } else if (orientation == "RAS") {
    notes.space = AnatomicalSpace::ras;
  } else if (orientation == "LPS") {
    notes.space = AnatomicalSpace::lps;
  } else {
    notes.other_space = orientation;
  }
}

void read_space(std::string_view comment, CoordinateNotes& notes) {
  constexpr std::string_view tag = "space";
  for (std::size_t at = 0; (at = find_word(comment, tag, at)) != std::string_view::npos;) {
    at += tag.size();
    std::string_view rest = comment.substr(at);
    skip_blanks(rest);
    if (!take(rest, "=")) continue;
    skip_blanks(rest);
    const auto end = std::find_if_not(rest.begin(), rest.end(), is_word);
    const std::string value =
        abbreviated(rest.substr(0, static_cast<std::size_t>(end - rest.begin())));
    if (is_orientation(value)) note_space(value, notes);
  }
}

void read_unit(std::string_view comment, CoordinateNotes& notes) {
  for (std::size_t at = 0; (at = find_word(comment, "1", at)) != std::string_view::npos; ++at) {
    std::string_view rest = comment.substr(at + 1);
    skip_blanks(rest);
    if (!take(rest, "unit")) continue;
    skip_blanks(rest);
    if (!take(rest, "=")) continue;
    skip_blanks(rest);
    double value = 0.0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error != std::errc{}) continue;
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    skip_blanks(rest);
    if (take(rest, "mm") && value > 0.0) notes.millimetres = value;
  }
}

template <class Read>
void for_each_piece(std::string_view text, char end, Read read) {
  while (!text.empty()) {
    const std::size_t size = std::min(text.find(end), text.size());
    read(text.substr(0, size));
    text.remove_prefix(std::min(size + 1, text.size()));
  }
}

/// Calls `read` with each line, whatever the line ends.
template <class Read>
void for_each_line(std::string_view text, Read read) {
  for_each_piece(text, '\n', [&](std::string_view line) { for_each_piece(line, '\r', read); });
}

}  // namespace

void read_notes(std::string_view comment, CoordinateNotes& notes) {
  read_space(comment, notes);
  read_unit(comment, notes);
}

CoordinateNotes notes_of_binary_stl(std::string_view beginning) {
  CoordinateNotes notes;
  read_notes(beginning.substr(0, 80), notes);
  return notes;
}

CoordinateNotes notes_of_text_stl(std::string_view contents) {
  CoordinateNotes notes;
  for_each_line(contents, [&](std::string_view line) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
    skip_blanks(line);
    // The names of solids are free text: it is looked for as such, not among their facets.
    take(line, "end");
    if (take(line, "solid")) read_notes(line, notes);
  });
  return notes;
}

CoordinateNotes notes_of_ply(const std::vector<std::string>& comments) {
  CoordinateNotes notes;
  for (const std::string& comment : comments) read_notes(comment, notes);
  return notes;
}

CoordinateNotes notes_after_hashes(std::string_view contents) {
  CoordinateNotes notes;
  for (std::size_t at = 0; (at = contents.find('#', at)) != std::string_view::npos;) {
    const std::size_t end = std::min(contents.find_first_of("\r\n", at), contents.size());
    read_notes(contents.substr(at + 1, end - at - 1), notes);
    at = end;
  }
  return notes;
}

}  // namespace keepout
