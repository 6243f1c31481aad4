// SPDX-License-Identifier: BSD-3-Clause
#include "serve/answer.h"

#include <array>
#include <charconv>
#include <cmath>
#include <ranges>
#include <utility>

namespace keepout::app {
namespace {

template <class Number>
void append_digits(std::string& text, Number value) {
  std::array<char, 32> digits;  // the longest double has 24
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

template <class Items, class Append>
void append_list(std::string& out, const Items& items, const Append& append) {
  char before = '[';
  for (const auto& item : items) {
    out += std::exchange(before, ',');
    append(item);
  }
  out += before == '[' ? "[]" : "]";
}

/// Of a step that is not ok there is no increment to tell, but a client who looks at nothing else
/// shall stand still.
void append_increment(std::string& out, std::span<const double> increment, std::size_t joints) {
  out += ",\"increment\":";
  append_list(out, std::views::iota(std::size_t{0}, joints), [&](std::size_t i) {
    append_number(out, i < increment.size() ? increment[i] : 0.0);
  });
}

template <class Numbers>
void append_numbers(std::string& out, const Numbers& numbers) {
  append_list(out, numbers, [&](double number) { append_number(out, number); });
}

/// Appends the names of all limits of a step, if there are any.
void append_limits(std::string& out, Limits limits) {
  if (limits.empty()) return;
  out += ",\"limits\":";
  char before = '[';
  for (std::size_t i = 0; i < limit_count; ++i) {
    const auto limit = static_cast<Limit>(i);
    if (!limits.has(limit)) continue;
    out += std::exchange(before, ',');
    append_string(out, name(limit));
  }
  out += ']';
}

/// Appends the pairs of body and mesh that keep less, if there are any; level null if a pair keeps
/// nothing.
void append_degraded(std::string& out, std::span<const DegradedClearance> degraded) {
  if (degraded.empty()) return;
  out += ",\"degraded\":";
  append_list(out, degraded, [&](const DegradedClearance& pair) {
    out += "{\"body\":";
    append_digits(out, pair.body);
    out += ",\"mesh\":";
    append_digits(out, pair.mesh);
    out += ",\"level\":";
    append_number(out, pair.is_certified ? pair.level : std::nan(""));
    out += '}';
  });
}

/// Appends how a step or a polytope ended, with a reason unless it is ok.
template <class Result>
void append_outcome(std::string& out, const Result& result) {
  out += result.ok() ? "\"ok\":true,\"status\":" : "\"ok\":false,\"status\":";
  append_string(out, name(result.status));
  if (result.ok()) return;
  out += ",\"reason\":";
  append_string(out, result.reason());
}

}  // namespace

void append_number(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += "null";
  } else if (value == 0.0) {
    text += std::signbit(value) ? "-0.0" : "0";
  } else {
    append_digits(text, value);
  }
}

void append_string(std::string& text, std::string_view value) {
  constexpr std::string_view hex = "0123456789abcdef";
  text += '"';
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (byte < 0x20) {
      text += "\\u00";
      text += hex[byte >> 4];
      text += hex[byte & 15];
    } else {
      text += c;
    }
  }
  text += '"';
}

void begin_answer(std::string& out, std::string_view id) {
  out += "{\"id\":";
  out += id;
}

void end_answer(std::string& out) { out += "}\n"; }

void append_step(std::string& out, const Step& step, std::size_t joints) {
  append_outcome(out, step);
  append_limits(out, step.limits);
  out += ",\"motion\":";
  append_numbers(out, step.motion);
  if (joints > 0) append_increment(out, step.increment, joints);
  out += ",\"triangles\":";
  append_digits(out, step.triangles);
  out += ",\"planes\":";
  append_digits(out, step.planes.size());
  if (step.distance) {
    out += ",\"distance\":";
    append_number(out, *step.distance);
  }
}

void append_polytope(std::string& out, const Polytope& polytope) {
  append_outcome(out, polytope);
  out += ",\"normals\":";
  append_list(out, polytope.planes, [&](const auto& plane) { append_numbers(out, plane.normal); });
  out += ",\"offsets\":";
  append_list(out, polytope.planes, [&](const auto& plane) { append_number(out, plane.offset); });
}

void append_instrument(std::string& out, const Instrument& instrument) {
  out += "\"ok\":true,\"joints\":";
  append_list(out, std::views::iota(1, instrument.chain().size() + 1),
              [&](int k) { append_string(out, instrument.chain().joint(k).name); });
  out += ",\"bodies\":";
  append_digits(out, instrument.bodies().size());
}

void append_joint_step(std::string& out, const InstrumentStep& step, std::size_t joints) {
  append_outcome(out, step);
  append_limits(out, step.limits);
  append_increment(out, step.increment, joints);
  out += ",\"share\":";
  append_number(out, step.share);
  if (step.level < 1.0) {
    out += ",\"level\":";
    append_number(out, step.level);
  }
  append_degraded(out, step.degraded);
  if (!step.distance) return;
  out += ",\"distance\":";
  append_number(out, *step.distance);
  out += ",\"nearest\":";
  append_digits(out, step.nearest);
}

void append_guides(std::string& out, std::span<const std::string> names,
                   std::span<const GuideState> states, Relaxation relaxation) {
  if (states.empty()) return;
  out += ",\"relaxation\":";
  append_string(out, name(relaxation));
  out += ",\"guides\":";
  append_list(out, std::views::iota(std::size_t{0}, states.size()), [&](std::size_t g) {
    out += "{\"name\":";
    append_string(out, names[g]);
    out += ",\"excess\":";
    append_number(out, states[g].excess);
    out += states[g].limits ? ",\"limits\":true" : ",\"limits\":false";
    out += states[g].relaxed ? ",\"relaxed\":true}" : ",\"relaxed\":false}";
  });
}

void append_error(std::string& out, std::string_view id, std::string_view kind,
                  std::string_view message) {
  begin_answer(out, id);
  out += ",\"error\":{\"kind\":";
  append_string(out, kind);
  out += ",\"message\":";
  append_string(out, message);
  out += '}';
  end_answer(out);
}

}  // namespace keepout::app
