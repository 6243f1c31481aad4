// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace keepout::app {

/// One line of input, without its end.
struct Line {
  bool is_too_long = false;  // it was skipped: there is no text
  std::string_view text;     // valid until the next room()
};

/// Cuts bytes that come in pieces into lines, in memory of a fixed size. Lines end with "\n" or
/// "\r\n". A line that is too long is skipped to its end, and told of once.
class LineReader {
 public:
  /// `longest`: of a line without its end. [bytes] Makes all memory here.
  explicit LineReader(std::size_t longest);

  /// Where the next bytes may be put; never empty once all lines have been taken.
  std::span<char> room() noexcept;

  /// That many bytes have been put there.
  void added(std::size_t count) noexcept { end_ += count; }

  /// No more bytes will come: what is left counts as a line.
  void ended() noexcept { has_ended_ = true; }

  /// The next whole line; nothing if more bytes are needed.
  std::optional<Line> next() noexcept;

 private:
  std::optional<Line> finished(std::size_t line_end, std::size_t next_begin) noexcept;

  std::size_t longest_;
  std::vector<char> buffer_;  // of the longest line and its end
  std::size_t begin_ = 0;     // of the line that is being read
  std::size_t searched_ = 0;  // no line ends before
  std::size_t end_ = 0;       // of what was read
  bool is_skipping_ = false;  // the beginning of this line is gone: it was too long
  bool has_ended_ = false;
};

}  // namespace keepout::app
