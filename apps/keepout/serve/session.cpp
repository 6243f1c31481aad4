// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "serve/session.h"

#include <algorithm>
#include <optional>

namespace keepout::app {
namespace {

constexpr std::size_t most_work = 16;                        // of a turn, in steps
constexpr std::size_t enough_output = std::size_t{1} << 16;  // for a turn [bytes]

}  // namespace

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
