// SPDX-License-Identifier: BSD-3-Clause
#include "report/html_report.h"

#include <algorithm>
#include <ostream>

#include "keepout/error.h"
#include "number_text.h"
#include "report/benchmark_report.h"
#include "report/benchmark_style.h"
#include "report/figures.h"
#include "report/page.h"
#include "report/text.h"
#include "report/verdict.h"
#include "report/views.h"

namespace keepout::app {
namespace {

// Twice what a large screen shows of it; close-ups are many, so they make do with a little less.
constexpr ImageSize overview_size = {1200, 900};
constexpr ImageSize close_up_size = {1000, 750};

using Summaries = std::vector<RunSummary>;

void print_verdict(std::ostream& out, const Simulation& simulation, const Summaries& summaries) {
  std::size_t strokes = 0;
  for (const RunSummary& summary : summaries) strokes = std::max(strokes, summary.strokes);
  out << "<p class=\"eyebrow\">A simulated hand pushed a tool into <strong>"
      << escape(simulation.mesh_name) << "</strong> in " << counted(strokes, "stroke")
      << ", the same for every rule that is to keep the tool out.</p>\n<h1>"
      << escape(headline(simulation, summaries)) << "</h1>\n<p class=\"account\">"
      << escape(account(simulation, summaries)) << "</p>\n";
}

void check(const Simulation& simulation) {
  if (simulation.mesh == nullptr || simulation.runs.empty()) {
    throw Error("nothing to report: there is no mesh, or no run");
  }
  for (const Run& run : simulation.runs) {
    if (run.strokes.empty() || run.strokes.size() != simulation.runs.front().strokes.size() ||
        std::any_of(run.strokes.begin(), run.strokes.end(),
                    [](const Stroke& stroke) { return stroke.cycles.empty(); })) {
      throw Error("cannot report on rule " + run.rule +
                  ": it lacks strokes that other rules have, or cycles in a stroke");
    }
  }
}

/// Two and four pictures make pairs, three a row.
std::size_t columns(std::size_t panels) {
  return panels == 3 || panels > 4 ? 3 : std::min<std::size_t>(panels, 2);
}

void open_panels(std::ostream& out, std::size_t count) {
  out << "<div class=\"panels\" style=\"--columns:" << columns(count) << "\">\n";
}

void print_name(std::ostream& out, const Simulation& simulation, std::size_t run) {
  out << "<span class=\"name " << rule_class(run) << "\"><span class=\"swatch\"></span>"
      << escape(display_name(simulation.runs[run])) << "</span>";
}

void print_overview(std::ostream& out, const Simulation& simulation, const Summaries& summaries) {
  const Overview view = overview(simulation, overview_size);
  out << shared_anatomy(view) << '\n';
  open_panels(out, simulation.runs.size());
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    const bool good = summaries[r].kept_out();
    const Run& run = simulation.runs[r];
    out << "<figure>" << overview_picture(simulation, view, r) << "<figcaption><span class=\"badge "
        << (good ? "good\">stayed out" : "bad\">went in") << "</span>";
    print_name(out, simulation, r);
    out << "<br>" << escape(outcome_of(summaries[r], simulation.surface));
    const std::string about = explanation(run);
    if (!about.empty()) out << "<br><span class=\"about\">" << escape(about) << "</span>";
    out << "</figcaption></figure>\n";
  }
  out << "</div>\n";
}

void print_close_ups(std::ostream& out, const Simulation& simulation, const Moment& moment) {
  const bool closed = simulation.surface == SurfaceKind::closed;
  out << "<h2>The stroke that tells most</h2>\n<p class=\"lead\">Stroke " << moment.stroke + 1
      << ", cut open along the path of the tip. "
      << (closed ? "Hatched is the anatomy; <b>red</b> is where the tip is inside it."
                 : "<b>Red</b> is where the tip is past the surface.")
      << " The ball marks the worst moment.</p>\n";
  open_panels(out, simulation.runs.size());
  const std::vector<CloseUp> views = close_ups(simulation, moment, close_up_size);
  for (std::size_t r = 0; r < views.size(); ++r) {
    out << "<figure>" << close_up_picture(simulation, moment, views[r], r) << "<figcaption>";
    print_name(out, simulation, r);
    out << "</figcaption></figure>\n";
  }
  out << "</div>\n";
}

/// A cell for a count or a depth that ought to be nothing.
void print_harm(std::ostream& out, const std::string& text, bool harm) {
  out << (harm ? "<td class=\"bad\">" : "<td>") << text << "</td>";
}

void print_row(std::ostream& out, const Simulation& simulation, const RunSummary& s,
               std::size_t run) {
  const auto time = [&](double value) {
    out << "<td>" << (s.max_us > 0.0 ? rounded(value) : "-") << "</td>";
  };
  const bool closed = simulation.surface == SurfaceKind::closed;
  out << "<tr><th scope=\"row\">";
  print_name(out, simulation, run);
  out << "</th>";
  print_harm(out, closed ? length_text(s.deepest_penetration) : "-", s.deepest_penetration > 0.0);
  print_harm(out, closed ? grouped(s.cycles_inside) : "-", s.cycles_inside > 0);
  print_harm(out, grouped(s.crossings), s.crossings > 0);
  out << "<td>" << length_text(touches(s.closest_approach) ? 0.0 : s.closest_approach)
      << "</td><td>" << grouped(s.cycles) << "</td><td>" << grouped(s.limited) << "</td><td>"
      << grouped(s.stopped) << "</td>";
  time(s.rate_khz);
  for (const double us : {s.p50_us, s.p99_us, s.p999_us, s.max_us}) time(us);
  out << "</tr>\n";
}

void print_table(std::ostream& out, const Simulation& simulation, const Summaries& summaries) {
  out << "<h2>The figures</h2>\n<p class=\"lead\">A crossing is a move after which, or during "
         "which, the tip was on the other side of the surface. The rate is how often the median "
         "step fits into a millisecond.</p>\n"
         "<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">rule</th>";
  for (const char* name : {"deepest inside", "cycles inside", "crossings", "closest approach",
                           "cycles", "cycles limited", "cycles stopped", "rate [kHz]",
                           "median step [µs]", "99 % [µs]", "99.9 % [µs]", "slowest [µs]"}) {
    out << "<th scope=\"col\">" << name << "</th>";
  }
  out << "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    print_row(out, simulation, summaries[r], r);
  }
  out << "</tbody></table></div>\n";
}

void print_plots(std::ostream& out, const Simulation& simulation, const Moment& moment) {
  out << "<h2>How near it came</h2>\n<p class=\"lead\">The same stroke " << moment.stroke + 1
      << " over time: how far the tip is from the surface, and the same enlarged around it.</p>\n"
      << "<div class=\"panels wide\" style=\"--columns:2\">\n<figure class=\"overlaid\">"
      << clearance_plot(simulation, moment.stroke) << "</figure>\n<figure class=\"overlaid\">"
      << near_surface_plot(simulation, moment.stroke) << "</figure>\n</div>\n";
}

void print_settings(std::ostream& out, const Simulation& simulation) {
  constexpr std::size_t one_line = 56;  // [character]; what is longer gets the whole width
  out << "<dl>";
  for (const auto& [name, value] : simulation.settings) {
    const char* wide = value.size() > one_line ? " class=\"wide\"" : "";
    out << "<dt" << wide << ">" << escape(name) << "</dt><dd" << wide << ">" << escape(value)
        << "</dd>";
  }
  out << "</dl>";
}

void print_times_and_settings(std::ostream& out, const Simulation& simulation) {
  const std::string times = step_time_plot(simulation);
  out << "<h2>" << (times.empty() ? "The settings" : "How fast it was, and the settings")
      << "</h2>\n<p class=\"lead\">"
      << (times.empty() ? ""
                        : "Read the plot at 1 %: one step in a hundred took this long or longer.")
      << "</p>\n<div class=\"panels wide\" style=\"--columns:2\">\n";
  if (!times.empty()) out << "<figure>" << times << "</figure>\n";
  out << "<figure>";
  print_settings(out, simulation);
  out << "</figure>\n</div>\n";
}

void print_method(std::ostream& out, const Simulation& simulation) {
  const bool closed = simulation.surface == SurfaceKind::closed;
  out << "<h2>How this was measured</h2>\n<p class=\"method\">A seeded random hand moves over the "
         "anatomy and pushes into it, cycle by cycle. Each rule gets the very same hand; it may "
         "shorten or turn each motion before the tool follows. In every cycle it is then checked "
         "where the tip really is. "
      << (closed ? "Inside or outside is told by counting how often a ray from the tip passes "
                   "through the surface, which shares nothing with the rules."
                 : "The surface has holes, so it has no inside: only crossings count. On which "
                   "side of the surface the tip is, is told by the angle-weighted normal at the "
                   "nearest point of it (the pseudonormal), which no rule uses. The tip may go "
                   "around a rim; sliding around one in contact counts as a crossing.")
      << " Distances come from a search tree (a PD-tree) and a closest-point computation that the "
         "rules may use too; the tests hold both to brute force and to an independent computation "
         "in quadruple precision. Depths up to 0.000001 mm count as touching, not as inside.</p>\n"
         "<p class=\"method\">Times are of the step alone, on the machine named above, with "
         "whatever else that machine did meanwhile.</p>\n";
}

void print_content(std::ostream& out, const Simulation& simulation) {
  Summaries summaries;
  for (const Run& run : simulation.runs) summaries.push_back(summarize(run));
  const Moment moment = telling_moment(simulation);
  print_verdict(out, simulation, summaries);
  print_overview(out, simulation, summaries);
  print_table(out, simulation, summaries);
  print_close_ups(out, simulation, moment);
  print_plots(out, simulation, moment);
  print_times_and_settings(out, simulation);
  print_method(out, simulation);
}

std::string title_of(const Simulation& simulation) {
  return simulation.mesh_name + " - keepout simulate";
}

}  // namespace

void print_report(std::ostream& out, const Simulation& simulation) {
  check(simulation);
  open_page(out, title_of(simulation), "");
  print_content(out, simulation);
  close_page(out);
}

void print_report(std::ostream& out, const Simulation& simulation, const Benchmark& benchmark,
                  const Comparison& comparison) {
  check(simulation);
  open_page(out, title_of(simulation), benchmark_style);
  print_content(out, simulation);
  print_benchmark_sections(out, benchmark, comparison);
  close_page(out);
}

}  // namespace keepout::app
