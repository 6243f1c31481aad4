// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <utility>

#include "base64.h"
#include "number_text.h"
#include "plan/planning_run.h"
#include "report/page.h"
#include "report/png.h"
#include "report/shading.h"
#include "report/table.h"
#include "report/text.h"
#include "report/tube.h"
#include "report/views.h"

namespace keepout::app {
namespace {

constexpr ImageSize picture_size{640, 640};

/// A path in lengths that are either allowed or not, the latter in the colour of alarm.
void add_tubes(const PlanningScene& where, const PlanningRun& run, double least, Rgb color,
               std::vector<Tube>& tubes) {
  constexpr double longest = 0.5;  // of what is judged at once [mm]
  const bool is_within = where.space == PlanningScene::Space::within;
  oracle::SafetyOracle oracle = where.scene.oracle();
  std::optional<bool> was_bad;
  for (std::size_t i = 1; i < run.path.points.size(); ++i) {
    const Vec3 from = run.path.points[i - 1];
    const Vec3 along = run.path.points[i] - from;
    const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm() / longest)));
    for (int k = 0; k < pieces; ++k) {
      const Vec3 a = from + along * (static_cast<double>(k) / pieces);
      const Vec3 b = from + along * (static_cast<double>(k + 1) / pieces);
      // What was found valid as a whole is not to look otherwise by the rounding of a piece.
      const bool is_bad = !run.verdict.is_valid() && oracle.check(a, b, least).below;
      if (was_bad != is_bad) {
        const bool is_seen = is_bad || is_within;
        tubes.push_back(
            {.points = {a},
             .radius = is_bad ? 3.0 : 1.8,
             .color = is_bad ? alarm_color : color,
             .sight = is_seen ? Tube::Sight::through_surface : Tube::Sight::hidden_by_surface});
        was_bad = is_bad;
      }
      tubes.back().points.push_back(b);
    }
  }
}

/// From the side and a little above, z upwards, as the fixtures stand.
Camera camera_of(const PlanningScene& where) {
  const Mesh& mesh = *where.scene.mesh();
  Camera camera = look_from(Vec3(0.9, -0.5, 0.35), Vec3::UnitZ(), mesh.bounds().center(), 1.0);
  const std::vector<Vec3> points(mesh.vertices().begin(), mesh.vertices().end());
  fit(camera, picture_size, points);
  return camera;
}

void print_pictures(std::ostream& out, const PlanOptions& options, const PlanningScene& where,
                    const std::vector<PlanningRun>& runs) {
  const Scene& scene = where.scene;
  const double least = least_distance(scene, options);
  const Camera camera = camera_of(where);
  const Samples samples = rasterize(*scene.mesh(), camera, picture_size, Interior::hollow);
  const Image anatomy = shade(samples);
  out << "<div class=\"panels\" style=\"--columns: 2\">\n";
  const std::vector<Checker> all = checkers(options.resolutions);
  for (std::size_t c = 0; c < all.size(); ++c) {
    std::vector<Tube> tubes;
    std::size_t solved = 0, invalid = 0;
    for (const PlanningRun& run : runs) {
      if (run.mesh != scene.name() || run.checker.name() != all[c].name()) continue;
      if (!run.path.solved) continue;
      ++solved;
      invalid += !run.verdict.is_valid();
      add_tubes(where, run, least, rule_color(c + 1), tubes);
    }
    const std::string words = all[c].name() + ": " + counted(solved, "path") + ", " +
                              std::to_string(invalid) + " not valid";
    const Image picture = lay_over(anatomy, draw_tubes(samples, camera, tubes));
    out << "<figure><img alt=\"" << escape(words)
        << "\" style=\"width:100%\" src=\"data:image/png;base64," << to_base64(to_png(picture))
        << "\"/><figcaption>" << escape(words) << "</figcaption></figure>\n";
  }
  out << "</div>\n";
}

Table table_of(const std::vector<PlanningSummary>& rows) {
  Table table;
  table.columns = {
      "checker",    "solved",       "valid",         "enters",     "least clearance (mm)",
      "median (s)", "checking (s)", "motions asked", "length (mm)"};
  using Look = TableCell::Look;
  for (const PlanningSummary& row : rows) {
    std::vector<TableCell>& cells = table.rows.emplace_back();
    cells.push_back({row.checker.name(), Look::name});
    for (std::string& cell : cells_of(row)) cells.push_back({std::move(cell)});
    if (row.valid != row.solved) cells[2].look = Look::bad;
    if (row.solved > 0) cells[3] = harm(row.entering);
  }
  return table;
}

}  // namespace

void write_planning_page(std::ostream& out, const PlanOptions& options,
                         const std::vector<PlanningScene>& scenes,
                         const std::vector<PlanningRun>& runs) {
  open_page(out, "keepout plan", "");
  out << "<h1>Plans through anatomy, judged by an exact oracle</h1>\n<p class=\"lead\">"
      << escape(lead(options)) << ". The sliding checker has a planner of its own.</p>\n";
  const std::vector<PlanningSummary> rows = summaries(runs);
  for (const PlanningScene& where : scenes) {
    std::vector<PlanningSummary> of_mesh;
    for (const PlanningSummary& row : rows) {
      if (row.mesh == where.scene.name()) of_mesh.push_back(row);
    }
    if (of_mesh.empty()) continue;
    open_section(out, escape(where.scene.name()),
                 "All paths found under each checker. Red: nearer to the mesh than allowed, or "
                 "through it.");
    print_table(out, table_of(of_mesh));
    print_pictures(out, options, where, runs);
  }
  close_page(out);
}

}  // namespace keepout::app
