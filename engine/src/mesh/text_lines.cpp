// SPDX-License-Identifier: BSD-3-Clause
#include "text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "keepout/error.h"

namespace keepout {
namespace {

constexpr bool is_line_end(char c) noexcept { return c == '\n' || c == '\r'; }
constexpr bool is_space(char c) noexcept { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }

/// Parses a whole word as a number. Returns result_out_of_range if the type cannot represent it.
template <class Number>
std::errc parse(std::string_view word, Number& value) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return end == word.data() + word.size() ? error : std::errc::invalid_argument;
}

/// Returns the value of a unit in the last place of a numeral.
double last_place(std::string_view numeral) {
  double unit = 1.0;
  bool is_behind_point = false;
  for (std::size_t i = 0; i < numeral.size(); ++i) {
    if (numeral[i] == '.') {
      is_behind_point = true;
    } else if (numeral[i] == 'e' || numeral[i] == 'E') {
      int exponent = 0;
      parse(numeral.substr(i + 1), exponent);
      return unit * std::pow(10.0, exponent);
    } else if (is_behind_point) {
      unit *= 0.1;
    }
  }
  return unit;
}

}  // namespace

TextLines::TextLines(std::string text, std::string file, LineRules rules)
    : contents_(std::move(text)),
      file_(std::move(file)),
      rules_(rules),
      next_number_(rules.first_line) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text_.starts_with(byte_order_mark)) position_ = byte_order_mark.size();
}

bool TextLines::next() {
  words_.clear();
  while (words_.empty() && position_ < text_.size()) {
    line_ = next_number_;
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

std::string_view TextLines::next_line() {
  words_.clear();
  const std::size_t begin = position_;
  line_ = next_number_;
  if (left() > 0) split_line();
  const std::string_view line = text_.substr(begin, position_ - begin);
  return line.substr(0, std::min(line.find_first_of("\r\n"), line.size()));
}

std::string_view TextLines::take_bytes(std::uint64_t count) noexcept {
  const std::string_view bytes = text_.substr(position_, static_cast<std::size_t>(count));
  position_ += bytes.size();
  next_number_ += static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), '\n'));
  return bytes;
}

void TextLines::split_line() {
  const auto begins_comment = [&](char c) { return rules_.comment != '\0' && c == rules_.comment; };
  std::size_t i = position_;
  while (i < text_.size() && !is_line_end(text_[i])) {
    const std::size_t begin = i;
    if (is_space(text_[i])) {
      ++i;
    } else if (begins_comment(text_[i])) {
      while (i < text_.size() && !is_line_end(text_[i])) ++i;
      comments_.emplace_back(text_.substr(begin + 1, i - begin - 1));
    } else {
      const auto ends_word = [&](char c) {
        return is_space(c) || is_line_end(c) || begins_comment(c);
      };
      while (i < text_.size() && !ends_word(text_[i])) ++i;
      words_.push_back(text_.substr(begin, i - begin));
    }
  }
  if (i < text_.size()) i += text_.substr(i).starts_with("\r\n") ? 2 : 1;
  position_ = i;
  ++next_number_;
}

std::string_view TextLines::after(std::string_view word) const noexcept {
  const auto begin = static_cast<std::size_t>(word.data() + word.size() - text_.data());
  return text_.substr(begin, text_.find_first_of("\r\n", begin) - begin);
}

void TextLines::warn_of_open_end(std::string_view lost, std::vector<std::string>& warnings) const {
  if (text_.empty() || is_line_end(text_.back())) return;
  warnings.push_back("the last line has no line end: if the file was cut short, " +
                     std::string(lost));
}

void TextLines::fail(const std::string& what) const {
  throw Error(file_ + ": line " + std::to_string(line_) + ": " + what);
}

template <class Real>
Real TextLines::number(std::string_view word) const {
  Real value = 0;
  std::errc error = parse(word, value);
  if (error == std::errc::result_out_of_range) {
    long double wide = 0;  // distinguishes numbers near 0 from huge ones
    error = parse(word, wide);
    value = static_cast<Real>(wide);
  }
  if (error != std::errc{}) {
    fail("expected a number, found " + in_quotes(word) +
         "; numbers need a decimal point, and no comma");
  }
  if (!std::isfinite(value)) {
    fail("a coordinate is not finite, or too large for its type: " + in_quotes(word) +
         "; repair the mesh and export it again");
  }
  return value;
}

template float TextLines::number(std::string_view) const;
template double TextLines::number(std::string_view) const;

double TextLines::coordinate(std::string_view word) {
  const double value = number<double>(word);
  const double off = std::abs(static_cast<double>(static_cast<float>(value)) - value);
  constexpr double half = 0.5 * (1.0 + 1e-6);  // plus the rounding of doubles
  if (off > 0.0 && has_only_floats_ && !(off <= half * last_place(word))) has_only_floats_ = false;
  return value;
}

Vec3 TextLines::vertex(std::size_t first) {
  if (words_.size() < first + 3) fail("a vertex needs three coordinates; the file is damaged");
  return {coordinate(words_[first]), coordinate(words_[first + 1]), coordinate(words_[first + 2])};
}

std::uint64_t TextLines::whole_number(std::string_view word) const {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) {
    fail("expected a whole number, found " + in_quotes(word) + "; the file is damaged");
  }
  return value;
}

std::string lower(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t longest = 24;
  std::string text = "'";
  for (const char c : word.substr(0, longest)) text += (c >= ' ' && c <= '~') ? c : '?';
  return text + (word.size() > longest ? "...'" : "'");
}

}  // namespace keepout
