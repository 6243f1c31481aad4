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

/// The rules of a text format for its lines.
struct LineRules {
  char comment = '\0';           // starts a comment, up to the end of the line; '\0': no comments
  bool backslash_joins = false;  // a backslash at the end continues a line
  std::size_t first_line = 1;    // the number of the text's first line in its file
};

/// The lines of a text that are not blank, split into words. Line ends may be LF, CRLF or CR.
class TextLines {
 public:
  /// `file` names the text in errors.
  TextLines(std::string text, std::string file, LineRules rules = {});
  /// Reads all of a file.
  explicit TextLines(const MeshSource& source, LineRules rules = {})
      : TextLines(source.contents(), source.name(), rules) {}
  TextLines(const TextLines&) = delete;
  TextLines& operator=(const TextLines&) = delete;

  /// Advances to the next line with a word. Returns false at the end of the text.
  bool next();
  /// Advances to the next line, even a blank one, and returns it without its line end; empty at the
  /// end of the text.
  std::string_view next_line();
  /// Returns the number of bytes after the current line.
  std::uint64_t left() const noexcept { return text_.size() - position_; }
  /// Skips the bytes after the current line and returns them. Precondition: `count` is at most
  /// left().
  std::string_view take_bytes(std::uint64_t count) noexcept;

  std::span<const std::string_view> words() const noexcept { return words_; }
  std::size_t line() const noexcept { return line_; }
  /// Returns the position of the next line in the text.
  std::size_t position() const noexcept { return position_; }
  /// Returns the text after one of the words on its line, with blanks.
  std::string_view after(std::string_view word) const noexcept;
  /// Warns if the text ends in the middle of a line, because it may have been truncated. `lost`:
  /// the consequence in that case.
  void warn_of_open_end(std::string_view lost, std::vector<std::string>& warnings) const;
  /// Returns the comments of the lines so far.
  std::vector<std::string> take_comments() noexcept { return std::move(comments_); }

  /// Throws Error with the file and the current line before `what`.
  [[noreturn]] void fail(const std::string& what) const;

  /// Returns a word as a number, rounded once. Throws Error unless it is decimal and finite.
  template <class Real>
  Real number(std::string_view word) const;
  /// Like number<double>(), and notes if the number may have been printed from a float.
  double coordinate(std::string_view word);
  /// Returns three coordinates, from the words `first` on. Throws Error if there are fewer words.
  Vec3 vertex(std::size_t first);
  /// Returns true if all coordinates so far may have been printed from floats.
  bool has_only_floats() const noexcept { return has_only_floats_; }
  /// Returns a word as a whole number without a sign. Throws Error if it is not one.
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

/// For formats whose counts detect all other losses.
inline constexpr std::string_view last_number_lost = "its last number may be another";

/// Returns the word in lower case (ASCII).
std::string lower(std::string_view word);

/// Returns the word in quotes for a message: short, and without control characters.
std::string in_quotes(std::string_view word);

}  // namespace keepout
