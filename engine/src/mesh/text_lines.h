// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh_file.h"

namespace keepout {

/// What a text format allows in its lines.
struct LineRules {
  char comment = '\0';           // starts one, up to the end of the line; '\0': there are none
  bool backslash_joins = false;  // a backslash at its end carries a line on in the next
  std::size_t first_line = 1;    // the number of the text's first line in its file
};

/// The lines of a text that hold anything, cut into words; whatever the line ends (LF, CRLF, CR).
class TextLines {
 public:
  /// `file` names the text in errors.
  TextLines(std::string text, std::string file, LineRules rules = {});
  /// Of all that is in a file.
  explicit TextLines(const MeshSource& source, LineRules rules = {})
      : TextLines(source.contents(), source.name(), rules) {}
  TextLines(const TextLines&) = delete;
  TextLines& operator=(const TextLines&) = delete;

  /// Moves on to the next line that has a word; false at the end of the text.
  bool next();
  /// Moves on to the next line, even a blank one, and returns it without its end; empty at the end
  /// of the text.
  std::string_view next_line();
  /// Returns the number of bytes behind the current line.
  std::uint64_t left() const noexcept { return text_.size() - position_; }
  /// Moves over the bytes behind the current line and returns them. Precondition: `count` is at
  /// most left().
  std::string_view take_bytes(std::uint64_t count) noexcept;

  std::span<const std::string_view> words() const noexcept { return words_; }
  std::size_t line() const noexcept { return line_; }
  /// Where the next line begins in the text.
  std::size_t position() const noexcept { return position_; }
  /// What follows one of the words on its line, blanks included.
  std::string_view after(std::string_view word) const noexcept;
  /// Warns if the text stops in the middle of a line: a sign that it may have been cut short, with
  /// which `lost` would be.
  void warn_of_open_end(std::string_view lost, std::vector<std::string>& warnings) const;
  /// Of the lines so far, where the format has them.
  std::vector<std::string> take_comments() noexcept { return std::move(comments_); }

  /// Throws Error with the file and the current line before `what`.
  [[noreturn]] void fail(const std::string& what) const;

  /// The word as a number, rounded but once. Throws Error unless it is decimal and finite.
  template <class Real>
  Real number(std::string_view word) const;
  /// The same of a double, for which is noted whether it may have been printed from a float.
  double coordinate(std::string_view word);
  /// Three of these, the words of the line from `first` on. Throws Error also if they are fewer.
  Vec3 vertex(std::size_t first);
  /// Whether all coordinates so far may have been: then the floats are what the file is about.
  bool has_only_floats() const noexcept { return has_only_floats_; }
  /// The word as a whole number without a sign. Throws Error if it is none.
  std::uint64_t whole_number(std::string_view word) const;

 private:
  void split_line();

  std::string contents_;
  std::string_view text_ = contents_;
  std::string file_;
  LineRules rules_;
  std::vector<std::string_view> words_;
  std::vector<std::string> comments_;
  std::size_t position_ = 0;
  std::size_t line_ = 0;
  std::size_t next_number_;  // of the next line
  bool has_only_floats_ = true;
};

/// Where counts tell of all other losses.
inline constexpr std::string_view last_number_lost = "its last number may be another";

/// The word in lower case (ASCII).
std::string lower(std::string_view word);

/// The word in quotes, fit for a message: short, and without control characters.
std::string in_quotes(std::string_view word);

}  // namespace keepout
