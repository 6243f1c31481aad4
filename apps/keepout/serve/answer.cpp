// SPDX-License-Identifier: BSD-3-Clause
#include "serve/answer.h"

#include <array>
#include <charconv>
#include <cmath>

namespace keepout::app {
namespace {

/// Appends the outcome of a step or a polytope, and the reason unless it is ok.
template <class Result>
void append_outcome(std::string& out, const Result& result) {
  append_member(out, "ok", result.ok());
  append_member(out, "status", name(result.status));
  if (!result.ok()) append_member(out, "reason", result.reason());
}

/// Appends the names of all limits of a step, if there are any.
void append_limits(std::string& out, Limits limits) {
  if (limits.empty()) return;
  append_member(out, "limits",
                std::views::iota(std::size_t{0}, limit_count) |
                    std::views::transform([](std::size_t i) { return static_cast<Limit>(i); }) |
                    std::views::filter([limits](Limit limit) { return limits.has(limit); }) |
                    std::views::transform([](Limit limit) { return name(limit); }));
}

/// Appends the increment of the joints. For a step that is not ok it consists of zeros, so that a
/// client that reads only the increment does not move.
void append_increment(std::string& out, std::span<const double> increment, std::size_t joints) {
  append_member(out, "increment",
                std::views::iota(std::size_t{0}, joints) | std::views::transform([&](auto i) {
                  return i < increment.size() ? increment[i] : 0.0;
                }));
}

/// Appends the pairs of body and mesh with degraded clearance, if there are any. The fraction is
/// null if no clearance of the pair is certified.
void append_degraded(std::string& out, std::span<const DegradedClearance> degraded) {
  if (degraded.empty()) return;
  append_member(out, "degraded", degraded | std::views::transform([](const auto& pair) {
                                   return [&pair](std::string& object) {
                                     append_member(object, "body", pair.body);
                                     append_member(object, "mesh", pair.mesh);
                                     append_member(
                                         object, "clearance_fraction",
                                         pair.is_certified ? pair.fraction : std::nan(""));
                                   };
                                 }));
}

}  // namespace

void append_number(std::string& out, double value) {
  if (!std::isfinite(value)) {
    out += "null";
  } else if (value == 0.0) {
    out += std::signbit(value) ? "-0.0" : "0";
  } else {
    std::array<char, 32> digits;  // a double has at most 24 characters
    out.append(digits.data(), std::to_chars(digits.begin(), digits.end(), value).ptr);
  }
}

void append_string(std::string& out, std::string_view value) {
  constexpr std::string_view hex = "0123456789abcdef";
  out += '"';
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20) {
      out += "\\u00";
      out += hex[byte >> 4];
      out += hex[byte & 15];
    } else {
      out += c;
    }
  }
  out += '"';
}

void append_step(std::string& out, const Step& step, std::size_t joints) {
  append_outcome(out, step);
  append_limits(out, step.limits);
  append_member(out, "motion", step.motion);
  if (joints > 0) append_increment(out, step.increment, joints);
  append_member(out, "triangles", step.triangles);
  append_member(out, "planes", step.planes.size());
  if (step.distance) append_member(out, "distance", *step.distance);
}

void append_polytope(std::string& out, const Polytope& polytope) {
  append_outcome(out, polytope);
  append_member(out, "normals", polytope.planes | std::views::transform(&HalfSpace::normal));
  append_member(out, "offsets", polytope.planes | std::views::transform(&HalfSpace::offset));
}

void append_joint_step(std::string& out, const InstrumentStep& step, std::size_t joints) {
  append_outcome(out, step);
  append_limits(out, step.limits);
  append_increment(out, step.increment, joints);
  append_member(out, "fraction", step.fraction);
  if (step.clearance_fraction < 1.0)
    append_member(out, "clearance_fraction", step.clearance_fraction);
  append_degraded(out, step.degraded);
  if (!step.distance) return;
  append_member(out, "distance", *step.distance);
  append_member(out, "nearest", step.nearest);
}

void append_guides(std::string& out, std::span<const std::string> names,
                   std::span<const GuideState> states, Relaxation relaxation) {
  if (states.empty()) return;
  append_member(out, "relaxation", name(relaxation));
  append_member(
      out, "guides",
      std::views::iota(std::size_t{0}, states.size()) | std::views::transform([&](std::size_t g) {
        return [&, g](std::string& object) {
          append_member(object, "name", names[g]);
          append_member(object, "excess", states[g].excess);
          append_member(object, "limits", states[g].limits);
          append_member(object, "relaxed", states[g].relaxed);
        };
      }));
}

void append_error(std::string& out, std::string_view id, std::string_view kind,
                  std::string_view message) {
  out.append("{\"id\":").append(id);
  append_member(out, "error", [&](std::string& object) {
    append_member(object, "kind", kind);
    append_member(object, "message", message);
  });
  out += "}\n";
}

}  // namespace keepout::app
