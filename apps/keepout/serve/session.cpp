// SPDX-License-Identifier: BSD-3-Clause
#include "serve/session.h"

#include <algorithm>
#include <cstring>

namespace keepout::app {
namespace {

constexpr std::size_t longest_end = 2;                       // of a line: "\r\n" [bytes]
constexpr std::size_t most_work = 16;                        // of a turn, in steps
constexpr std::size_t enough_output = std::size_t{1} << 16;  // for a turn [bytes]

}  // namespace

LineReader::LineReader(std::size_t longest) : longest_(longest), buffer_(longest + longest_end) {}

std::span<char> LineReader::room() noexcept {
  if (begin_ == end_) {
    begin_ = searched_ = end_ = 0;
  } else if (begin_ > 0 && end_ == buffer_.size()) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    searched_ -= begin_;
    end_ -= begin_;
    begin_ = 0;
  }
  return {buffer_.data() + end_, buffer_.size() - end_};
}

std::optional<Line> LineReader::next() noexcept {
  const auto first = buffer_.begin() + static_cast<std::ptrdiff_t>(searched_);
  const auto last = buffer_.begin() + static_cast<std::ptrdiff_t>(end_);
  const auto newline = std::find(first, last, '\n');
  if (newline != last) {
    const auto at = static_cast<std::size_t>(newline - buffer_.begin());
    return finished(at, at + 1);
  }
  searched_ = end_;
  if (has_ended_ && (begin_ < end_ || is_skipping_)) return finished(end_, end_);
  if (is_skipping_ || end_ - begin_ == buffer_.size()) {
    is_skipping_ = true;
    begin_ = searched_ = end_ = 0;
  }
  return std::nullopt;
}

std::optional<Line> LineReader::finished(std::size_t line_end, std::size_t next_begin) noexcept {
  std::string_view text(buffer_.data() + begin_, line_end - begin_);
  if (text.ends_with('\r')) text.remove_suffix(1);
  begin_ = searched_ = next_begin;
  const bool is_too_long = is_skipping_ || text.size() > longest_;
  is_skipping_ = false;
  return Line{is_too_long, is_too_long ? std::string_view() : text};
}

Session::Session(Service& service)
    : service_(service), lines_(service.longest_line()), tip_(service.new_watch()) {
  out_.reserve(enough_output / 4);
}

void Session::take_turn() {
  std::size_t work = 0;
  while (work < most_work && out_.size() < enough_output) {
    const std::optional<Line> line = lines_.next();
    may_have_line_ = line.has_value();
    if (!line) return;
    // A blank line is no work, but a sea of them must not hold up the others.
    work += std::max<std::size_t>(service_.answer(*line, tip_, out_), 1);
  }
}

void Session::sent(std::size_t count) noexcept {
  sent_ += count;
  if (sent_ < out_.size()) return;
  out_.clear();
  sent_ = 0;
}

}  // namespace keepout::app
