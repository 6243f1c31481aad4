// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "keepout/error.h"
#include "number_text.h"
#include "report/html_report.h"
#include "report/text.h"
#include "report/verdict.h"
#include "report/views.h"
#include "report_scene.h"

namespace keepout::app {
namespace {

TEST(Text, NumbersReadWell) {
  EXPECT_EQ(grouped(24000), "24,000");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(rounded(0.0012345), "0.00123");
  EXPECT_EQ(rounded(12.0), "12.0");
  EXPECT_EQ(trimmed(12.0), "12");
  EXPECT_EQ(trimmed(-0.5), "-0.5");
  EXPECT_EQ(trimmed(1200.0), "1200");
  EXPECT_EQ(trimmed(155.6996), "155.7");
  EXPECT_EQ(trimmed(1234567.8), "1234568");
  EXPECT_EQ(trimmed(-1e-17), "0");
  EXPECT_EQ(how_often(1), "once");
  EXPECT_EQ(how_often(2), "twice");
  EXPECT_EQ(how_often(1200), "1,200 times");
  EXPECT_EQ(length_text(1.2345), "1.23\u00a0mm");
  EXPECT_EQ(length_text(0.0012345), "1.23\u00a0µm");
  EXPECT_EQ(listed({"a", "b", "c"}), "a, b and c");
}

TEST(Verdict, NamesTheRulesThatFailAndHowDeep) {
  const Mesh mesh(tetrahedron());
  const Simulation simulation = tetrahedron_simulation(mesh);
  std::vector<RunSummary> summaries;
  for (const app::Run& run : simulation.runs) summaries.push_back(summarize(run));
  EXPECT_EQ(headline(simulation, summaries),
            "Rule “leaky” let the tool into the anatomy; “safe” kept it out.");
  const std::string text = account(simulation, summaries);
  EXPECT_NE(text.find("Under “leaky” it went up to 0.0200\u00a0mm deep, in 1 of 1 stroke."),
            std::string::npos)
      << text;
}

TEST(Verdict, SaysWhetherARuleThatKeptTheToolOutTouched) {
  const auto outcome = [](double clearance) {
    app::Run run{.rule = "some", .description = ""};
    run.strokes = {{{cycle({0, 0, 0}, clearance)}}};
    return outcome_of(summarize(run), SurfaceKind::open);
  };
  EXPECT_EQ(outcome(0.0), "stayed outside but touched the surface");
  EXPECT_EQ(outcome(9e-7), "stayed outside but touched the surface");
  EXPECT_EQ(outcome(2e-6), "stayed outside, never nearer than 2.00\u00a0nm");
}

TEST(Verdict, CountsCrossingsOfAnOpenSurfaceInWords) {
  app::Run run{.rule = "some", .description = ""};
  run.strokes = {{std::vector<Cycle>(5, cycle({0, 0, 0}, 1.0))}, {{cycle({0, 0, 0}, 1.0)}}};
  run.crossings = {{0, 1}};
  EXPECT_EQ(outcome_of(summarize(run), SurfaceKind::open),
            "went through the surface once, in 1 of 2 strokes");
}

std::string page_of(const Simulation& simulation) {
  std::ostringstream page;
  print_report(page, simulation);
  return page.str();
}

TEST(Report, TellsHowTheCheckDecides) {
  const Mesh mesh(flat_ground());
  const std::string closed = page_of(slides(mesh, 0.0));
  EXPECT_NE(closed.find("a ray from the tip passes"), std::string::npos);
  EXPECT_NE(closed.find("brute force"), std::string::npos);
  EXPECT_NE(closed.find("after which, or during which, the tip was on the other side of"),
            std::string::npos);
  const std::string open = page_of(slides(mesh, 0.0, SurfaceKind::open));
  EXPECT_EQ(open.find("a ray from the tip passes"), std::string::npos);
  EXPECT_NE(open.find("pseudonormal"), std::string::npos);
}

TEST(Report, ALongSettingGetsTheWholeWidth) {
  const Mesh mesh(flat_ground());
  Simulation simulation = slides(mesh, 0.0);
  simulation.settings = {{"seed", "1"}, {"command", "keepout simulate " + std::string(80, 'x')}};
  const std::string page = page_of(simulation);
  EXPECT_NE(page.find("<dt>seed</dt><dd>1</dd>"), std::string::npos);
  EXPECT_NE(page.find("<dt class=\"wide\">command</dt><dd class=\"wide\">keepout simulate x"),
            std::string::npos);
}

TEST(Report, IsOneWellFormedPageThatNeedsNothingElse) {
  const Mesh mesh(tetrahedron());
  const Simulation simulation = tetrahedron_simulation(mesh);
  const std::string page = page_of(simulation);
  EXPECT_EQ(fault_in_html(page), "");
  for (const char* reference : {"http:", "https:", "src=", "url(", "@import", "<script", "<link"}) {
    EXPECT_EQ(page.find(reference), std::string::npos) << reference;
  }
  for (std::size_t at = page.find("href=\""); at != std::string::npos;
       at = page.find("href=\"", at + 1)) {
    const std::string target = page.substr(at + 6, 22);
    EXPECT_TRUE(target.starts_with('#') || target == "data:image/png;base64,") << target;
  }
  EXPECT_NE(page.find("&lt;tetra&gt; &amp; &quot;friends&quot;"), std::string::npos);
  EXPECT_EQ(page.find("<tetra>"), std::string::npos);
  EXPECT_NE(page.find("&lt;1&gt;"), std::string::npos);
}

TEST(Report, RefusesWhatItCannotShow) {
  const Mesh mesh(tetrahedron());
  Simulation simulation = tetrahedron_simulation(mesh);
  std::ostringstream page;
  simulation.runs[1].strokes.clear();
  EXPECT_THROW(print_report(page, simulation), Error);
  simulation.runs.clear();
  EXPECT_THROW(print_report(page, simulation), Error);
}

}  // namespace
}  // namespace keepout::app
