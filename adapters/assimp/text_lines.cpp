// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "text_lines.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "keepout/error.h"

namespace keepout {
namespace {

// Assimp adds digits up in 64 bits, and goes on with a zero when they overflow.
constexpr std::size_t most_digits = 18;
constexpr std::size_t most_exponent_digits = 4;
constexpr std::size_t longest_number = 100;

constexpr bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }
constexpr bool is_line_end(char c) noexcept { return c == '\n' || c == '\r'; }
constexpr bool is_space(char c) noexcept { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }

/// Takes the digits that `word` begins with off it, and returns how many there were.
std::size_t take_digits(std::string_view& word) noexcept {
  const auto end = std::find_if_not(word.begin(), word.end(), is_digit);
  const auto count = static_cast<std::size_t>(end - word.begin());
  word.remove_prefix(count);
  return count;
}

void take_sign(std::string_view& word) noexcept {
  if (!word.empty() && (word.front() == '-' || word.front() == '+')) word.remove_prefix(1);
}

bool is_number(std::string_view word) noexcept {
  if (word.size() > longest_number) return false;
  take_sign(word);
  const std::size_t whole_digits = take_digits(word);
  if (whole_digits > most_digits) return false;
  std::size_t digits = whole_digits;
  if (word.starts_with('.')) {
    word.remove_prefix(1);
    digits += take_digits(word);
  }
  if (digits == 0) return false;
  if (word.starts_with('e') || word.starts_with('E')) {
    word.remove_prefix(1);
    take_sign(word);
    const std::size_t exponent_digits = take_digits(word);
    if (exponent_digits == 0 || exponent_digits > most_exponent_digits) return false;
  }
  return word.empty();
}

bool is_not_finite(std::string_view word) {
  take_sign(word);
  std::string lower(word.substr(0, 4));
  for (char& c : lower) c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
  return lower.starts_with("nan") || lower.starts_with("inf");
}

}  // namespace

TextLines::TextLines(std::string_view text, std::string file, LineRules rules)
    : text_(text), file_(std::move(file)), rules_(rules) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text_.starts_with(byte_order_mark)) position_ = byte_order_mark.size();
}

bool TextLines::next() {
  words_.clear();
  while (words_.empty() && position_ < text_.size()) {
    line_ = next_line_;
    split_line();
    while (rules_.backslash_joins && !words_.empty() && words_.back().ends_with('\\')) {
      words_.back().remove_suffix(1);
      if (words_.back().empty()) words_.pop_back();
      if (position_ >= text_.size()) break;
      split_line();
    }
  }
  return !words_.empty();
}

void TextLines::split_line() {
  std::size_t i = position_;
  while (i < text_.size() && !is_line_end(text_[i])) {
    if (is_space(text_[i])) {
      ++i;
      continue;
    }
    if (rules_.comment != '\0' && text_[i] == rules_.comment) {
      while (i < text_.size() && !is_line_end(text_[i])) ++i;
      break;
    }
    const std::size_t begin = i;
    while (i < text_.size() && !is_space(text_[i]) && !is_line_end(text_[i])) ++i;
    words_.push_back(text_.substr(begin, i - begin));
  }
  if (i < text_.size()) {
    const bool two = text_[i] == '\r' && i + 1 < text_.size() && text_[i + 1] == '\n';
    i += two ? 2 : 1;
  }
  position_ = i;
  ++next_line_;
}

bool TextLines::ends_within_a_line() const noexcept {
  return !text_.empty() && !is_line_end(text_.back());
}

void TextLines::fail(const std::string& what) const {
  throw Error(file_ + ": line " + std::to_string(line_) + ": " + what);
}

void TextLines::expect_number(std::string_view word) const {
  if (is_number(word)) return;
  if (is_not_finite(word)) {
    fail("a coordinate is not finite: " + quoted(word) + "; repair the mesh and export it again");
  }
  fail("expected a number, found " + quoted(word) +
       "; numbers need a decimal point, at most 18 digits before it, and no comma");
}

std::uint64_t TextLines::whole_number(std::string_view word) const {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) {
    fail("expected a whole number, found " + quoted(word) + "; the file is damaged");
  }
  return value;
}

std::string quoted(std::string_view word) {
  constexpr std::size_t longest = 24;
  std::string text = "'";
  for (const char c : word.substr(0, longest)) text += (c >= ' ' && c <= '~') ? c : '?';
  return text + (word.size() > longest ? "...'" : "'");
}

}  // namespace keepout
