// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation_summary.h"

#include <array>
#include <cstdio>
#include <ostream>
#include <sstream>
#include <string>

#include "number_text.h"
#include "report/text.h"
#include "report/verdict.h"

namespace keepout::app {
namespace {

std::string fixed(double value, int decimals) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

/// Characters, not bytes: ours are in UTF-8.
std::size_t width_of(const std::string& word) {
  std::size_t width = 0;
  for (const char c : word) width += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return width;
}

/// In lines that fit a terminal.
void print_wrapped(std::ostream& out, const std::string& text) {
  constexpr std::size_t longest = 88;
  std::istringstream words(text);
  std::size_t width = 0;
  for (std::string word; words >> word;) {
    const std::size_t more = width_of(word);
    if (width > 0) {
      const bool fits = width + 1 + more <= longest;
      out << (fits ? ' ' : '\n');
      width = fits ? width + 1 : 0;
    }
    out << word;
    width += more;
  }
  out << '\n';
}

}  // namespace

void print_summary(std::ostream& out, const Simulation& simulation) {
  std::vector<RunSummary> summaries;
  for (const Run& run : simulation.runs) summaries.push_back(summarize(run));
  const RunSummary& first = summaries.front();
  print_wrapped(out, "A simulated hand pushed a tool over and into " + simulation.mesh_name + " (" +
                         counted(simulation.mesh->triangle_count(), "triangle") +
                         "): " + counted(first.strokes, "stroke") + ", " +
                         counted(first.cycles, "cycle") + " of 1 ms, without a fixture and under " +
                         counted(summaries.size() - 1, "rule") + ", margin " +
                         length_text(simulation.margin) + ".");
  out << '\n';
  print_wrapped(out, headline(simulation, summaries));
  print_wrapped(out, account(simulation, summaries));
  std::vector<std::string> times;
  for (std::size_t r = 0; r < summaries.size(); ++r) {
    if (summaries[r].p50_us <= 0.0) continue;
    times.push_back(time_text(summaries[r].p50_us) + " under “" + display_name(simulation.runs[r]) +
                    "”");
  }
  if (!times.empty()) print_wrapped(out, "Half of the steps took at most " + listed(times) + ".");
}

void print_table(std::ostream& out, const Simulation& simulation) {
  std::array<char, 256> line;
  std::snprintf(line.data(), line.size(), "%-10s %8s %9s %9s %9s %12s %12s %8s %10s %9s\n", "rule",
                "cycles", "kHz", "p50 us", "p99 us", "closest mm", "deepest mm", "inside",
                "crossings", "stopped");
  out << line.data();
  const bool closed = simulation.surface == SurfaceKind::closed;  // an open one has no inside
  for (const Run& run : simulation.runs) {
    const RunSummary s = summarize(run);
    // Without a fixture there is no step to be timed.
    const auto time = [&](double value, int decimals) {
      return s.max_us > 0.0 ? fixed(value, decimals) : "-";
    };
    std::snprintf(line.data(), line.size(), "%-10s %8zu %9s %9s %9s %12.4f %12s %8s %10zu %9zu\n",
                  run.rule.c_str(), s.cycles, time(s.rate_khz, 1).c_str(),
                  time(s.p50_us, 2).c_str(), time(s.p99_us, 2).c_str(), s.closest_approach,
                  closed ? fixed(s.deepest_penetration, 4).c_str() : "-",
                  closed ? std::to_string(s.cycles_inside).c_str() : "-", s.crossings, s.stopped);
    out << line.data();
  }
}

}  // namespace keepout::app
