// SPDX-License-Identifier: BSD-3-Clause
#include "report/views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "report/raster.h"
#include "report/shading.h"

namespace keepout::app {
namespace {

/// The path of a stroke, taken apart where the tip goes in and out: what is inside is drawn through
/// the surface, in the colour of alarm.
std::vector<Tube> stroke_tubes(const Simulation& simulation, std::size_t run, std::size_t stroke,
                               double radius) {
  const std::vector<Cycle>& cycles = simulation.runs[run].strokes[stroke].cycles;
  const std::vector<bool> bad = trespass(simulation.runs[run], stroke, simulation.surface);
  std::vector<Tube> tubes;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    if (i == 0 || bad[i] != bad[i - 1]) {
      Tube tube;
      tube.radius = radius;
      // The move that leads in or out belongs to what is drawn over the rest.
      if (i > 0 && bad[i]) tube.points.push_back(cycles[i - 1].tip);
      if (i > 0 && !bad[i]) tubes.back().points.push_back(cycles[i].tip);
      tube.color = bad[i] ? alarm_color : rule_color(run);
      tube.sight = bad[i] ? Tube::Sight::through_surface : Tube::Sight::hidden_by_surface;
      tubes.push_back(std::move(tube));
    }
    tubes.back().points.push_back(cycles[i].tip);
  }
  return tubes;
}

/// Every so many cycles the tip of each stroke of a run.
std::vector<Vec3> some_tips(const Run& run) {
  constexpr std::size_t every = 10;
  std::vector<Vec3> tips;
  for (const Stroke& stroke : run.strokes) {
    for (std::size_t i = 0; i < stroke.cycles.size(); i += every) {
      tips.push_back(stroke.cycles[i].tip);
    }
  }
  return tips;
}

Camera whole(const Simulation& simulation, const Vec3& toward, ImageSize size) {
  const Mesh& mesh = *simulation.mesh;
  Camera camera = look_from(toward, simulation.up, mesh.bounds().center(), 1.0);
  std::vector<Vec3> points(mesh.vertices().begin(), mesh.vertices().end());
  for (const Run& run : simulation.runs) {
    const std::vector<Vec3> tips = some_tips(run);
    points.insert(points.end(), tips.begin(), tips.end());
  }
  fit(camera, size, points);
  camera.view_height *= 1.08;  // leaves a strip for the scale bar below
  camera.target -= 0.035 * camera.view_height * camera.up;
  return camera;
}

/// Ways to look from all around, level and from a little above, as a person would.
std::vector<Vec3> viewpoints(const Vec3& up) {
  const Vec3 east = up.unitOrthogonal();
  const Vec3 north = up.normalized().cross(east);
  std::vector<Vec3> result;
  for (const double elevation : {0.1, 0.45}) {
    for (int k = 0; k < 12; ++k) {
      const double azimuth = std::numbers::pi * static_cast<double>(k) / 6.0;
      result.push_back(std::cos(elevation) *
                           (std::cos(azimuth) * east + std::sin(azimuth) * north) +
                       std::sin(elevation) * up.normalized());
    }
  }
  return result;
}

/// The viewpoint that sees most of the paths, on small trial pictures.
Camera best_camera(const Simulation& simulation, ImageSize size) {
  const ImageSize trial = {size.width / 8, size.height / 8};
  const double slack = 0.01 * simulation.mesh->bounds().size().norm();
  std::vector<Vec3> tips;
  if (!simulation.runs.empty()) tips = some_tips(simulation.runs.back());
  Camera best;
  std::ptrdiff_t most = -1;
  for (const Vec3& toward : viewpoints(simulation.up)) {
    const Camera camera = whole(simulation, toward, size);
    const Samples samples = rasterize(*simulation.mesh, camera, trial, Interior::hollow);
    const std::ptrdiff_t seen = std::count_if(tips.begin(), tips.end(), [&](const Vec3& tip) {
      return sees(samples, camera, tip, slack);
    });
    if (seen > most) {
      most = seen;
      best = camera;
    }
  }
  return best;
}

/// Mean outward direction of the surface around a point, weighted by area.
Vec3 outward(const Mesh& mesh, const Vec3& point, double radius) {
  Vec3 sum = Vec3::Zero();
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle corners = mesh.triangle(t);
    const Vec3 center = (corners[0] + corners[1] + corners[2]) / 3.0;
    if ((center - point).squaredNorm() > radius * radius) continue;
    sum += (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  }
  return sum;
}

/// Where the tip went in on its way to a cycle; the cycle itself where it never did.
std::size_t entry(const Run& run, const Moment& moment, SurfaceKind surface) {
  const std::vector<bool> bad = trespass(run, moment.stroke, surface);
  std::size_t cycle = moment.cycle;
  while (cycle > 0 && bad[cycle]) --cycle;
  return cycle;
}

/// How deep a run went in a stroke; 0 where it did not, or where an open surface tells no depth.
double depth_in(const Run& run, std::size_t stroke) {
  return std::max(0.0, -run.strokes[stroke].cycles[worst_cycle(run, stroke)].clearance);
}

/// Where the tip was in one stroke, under all rules.
std::vector<Vec3> tips_in(const Simulation& simulation, std::size_t stroke) {
  std::vector<Vec3> tips;
  for (const Run& run : simulation.runs) {
    for (const Cycle& cycle : run.strokes[stroke].cycles) tips.push_back(cycle.tip);
  }
  return tips;
}

/// How much of the scene a close-up of a depth shows: enough to see it for what it is, and, as far
/// as that allows, how deep the tool goes without a fixture.
double close_up_height(const Simulation& simulation, const Moment& moment) {
  double deepest = 0.0;
  for (const Run& run : simulation.runs) {
    deepest = std::max(deepest, depth_in(run, moment.stroke));
  }
  const double told = depth_in(simulation.runs[moment.run], moment.stroke);
  return std::max(std::clamp(2.5 * deepest, 5.0 * told, 14.0 * told),
                  1e-3 * simulation.mesh->bounds().size().norm());
}

struct CloseCamera {
  Camera camera;
  Vec3 out;  // away from the anatomy
};

/// Looks at the marked place from the side of its stroke. `height` is that of the view. [mm]
CloseCamera look_at(const Simulation& simulation, const Moment& moment, double height) {
  const Run& run = simulation.runs[moment.run];
  const std::vector<Cycle>& cycles = run.strokes[moment.stroke].cycles;
  const Vec3 place = cycles[moment.cycle].tip;
  const Vec3 came_in = cycles[entry(run, moment, simulation.surface)].tip;

  constexpr double widest = 4.0;  // [mm]: of a thin branch, not also the far side
  Vec3 out =
      outward(*simulation.mesh, came_in, std::min(0.3 * height, widest) + (came_in - place).norm());
  if (out.norm() == 0.0) out = cycles.front().hand - place;
  if (out.norm() == 0.0) out = simulation.up;
  out.normalize();

  // Sideways to the way of the tip, so that the picture shows the length of it.
  Vec3 along = Vec3::Zero();
  for (const Cycle& cycle : cycles) {
    const Vec3 offset = cycle.tip - place;
    if (offset.norm() > height) continue;
    const Vec3 level = offset - out.dot(offset) * out;
    along += along.dot(level) < 0.0 ? Vec3(-level) : level;
  }
  if (along.norm() == 0.0) along = out.unitOrthogonal();
  Vec3 side = along.cross(out).normalized();
  if (side.dot(simulation.up) < 0.0) side = -side;

  // From a little above, the surface shows as the ground and the cut as its front. The surface is
  // set somewhat above the middle: most of what there is to see is at it, the rest is below.
  const double depth = std::max(0.0, -cycles[moment.cycle].clearance);
  const Vec3 target = place + (depth - 0.12 * height) * out;
  return {look_from(side + 0.35 * out, out, target, height), out};
}

/// Shows the whole stroke, or, where a depth would be too small to see in that, the depth alone.
CloseCamera close_camera(const Simulation& simulation, const Moment& moment, ImageSize size) {
  const std::vector<Vec3> tips = tips_in(simulation, moment.stroke);
  Box around{tips.front(), tips.front()};
  for (const Vec3& tip : tips) {
    around = {around.low.cwiseMin(tip), around.high.cwiseMax(tip)};
  }
  const double least = 0.02 * simulation.mesh->bounds().size().norm();
  CloseCamera wide = look_at(simulation, moment, std::max(around.size().norm(), least));
  fit(wide.camera, size, tips);
  // Leaves room for labels, and for the scale bar below.
  wide.camera.view_height = std::max(1.22 * wide.camera.view_height, least);
  wide.camera.target -= 0.06 * wide.camera.view_height * wide.camera.up;

  constexpr double visible = 0.03;  // of the height of the picture
  const double told = depth_in(simulation.runs[moment.run], moment.stroke);
  if (told == 0.0 || told >= visible * wide.camera.view_height) return wide;
  return look_at(simulation, moment, close_up_height(simulation, moment));
}

/// The cycle that a close-up marks. A run that got in is told at its worst, be that out of sight;
/// of one that stayed outside, its nearest approach in sight tells more.
std::size_t marked_cycle(const Simulation& simulation, std::size_t run, const Moment& moment,
                         const Camera& camera, ImageSize size) {
  if (run == moment.run) return moment.cycle;
  const std::size_t worst = worst_cycle(simulation.runs[run], moment.stroke);
  if (trespass(simulation.runs[run], moment.stroke, simulation.surface)[worst]) return worst;
  const std::vector<Cycle>& cycles = simulation.runs[run].strokes[moment.stroke].cycles;
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    if (!shows(camera, size, cycles[i].tip)) continue;
    if (!nearest || cycles[i].clearance < cycles[*nearest].clearance) nearest = i;
  }
  return nearest.value_or(worst);
}

CloseUp close_up(const Simulation& simulation, std::size_t run, const Moment& moment, Camera camera,
                 const Vec3& out, ImageSize size) {
  const double radius = 0.005 * static_cast<double>(size.height);
  const Stroke& stroke = simulation.runs[run].strokes[moment.stroke];
  const std::size_t worst = marked_cycle(simulation, run, moment, camera, size);

  camera.cut = Cut{{}, worst, out};
  for (const Cycle& cycle : stroke.cycles) camera.cut->path.push_back(cycle.tip);

  std::vector<Tube> tubes = stroke_tubes(simulation, run, moment.stroke, radius);
  const bool bad = trespass(simulation.runs[run], moment.stroke, simulation.surface)[worst];
  tubes.push_back({.points = {stroke.cycles[worst].tip},
                   .radius = 2.2 * radius,
                   .color = bad ? alarm_color : rule_color(run),
                   .sight = Tube::Sight::through_surface});

  const Interior interior =
      simulation.surface == SurfaceKind::closed ? Interior::solid : Interior::hollow;
  const Samples samples = rasterize(*simulation.mesh, camera, size, interior);
  return {camera, lay_over(shade(samples), draw_tubes(samples, camera, tubes)), worst};
}

}  // namespace

Rgb rule_color(std::size_t run) {
  static constexpr std::array<Rgb, 6> colors = {
      {{92, 104, 122}, {24, 100, 220}, {150, 70, 214}, {0, 142, 120}, {214, 120, 0}, {70, 60, 50}}};
  return colors[run % colors.size()];
}

std::size_t worst_cycle(const Run& run, std::size_t stroke) {
  const std::vector<Cycle>& cycles = run.strokes[stroke].cycles;
  const auto lowest =
      std::min_element(cycles.begin(), cycles.end(),
                       [](const Cycle& a, const Cycle& b) { return a.clearance < b.clearance; });
  if (lowest->clearance >= 0.0) {
    for (const Crossing& crossing : run.crossings) {
      if (crossing.stroke == stroke) return crossing.cycle;
    }
  }
  return static_cast<std::size_t>(lowest - cycles.begin());
}

Moment worst_moment(const Run& run, std::size_t number) {
  const auto clearance = [&](std::size_t stroke, std::size_t cycle) {
    return run.strokes[stroke].cycles[cycle].clearance;
  };
  Moment worst{number, 0, worst_cycle(run, 0)};
  for (std::size_t s = 1; s < run.strokes.size(); ++s) {
    const std::size_t c = worst_cycle(run, s);
    if (clearance(s, c) < clearance(worst.stroke, worst.cycle)) worst = {number, s, c};
  }
  if (clearance(worst.stroke, worst.cycle) >= 0.0 && !run.crossings.empty()) {
    worst = {number, run.crossings.front().stroke, run.crossings.front().cycle};
  }
  return worst;
}

Moment telling_moment(const Simulation& simulation) {
  // A rule that failed tells most, then what the fixture is for, then how near a rule came.
  const auto rank = [&](const Moment& moment) {
    const Run& run = simulation.runs[moment.run];
    const double clearance = run.strokes[moment.stroke].cycles[moment.cycle].clearance;
    const int kind = clearance >= 0.0 && run.crossings.empty() ? 0 : run.rule == no_rule ? 1 : 2;
    return std::pair(kind, -clearance);
  };
  std::optional<Moment> best;
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    const Moment moment = worst_moment(simulation.runs[r], r);
    if (!best || rank(moment) > rank(*best)) best = moment;
  }
  return best.value_or(Moment{});
}

Overview overview(const Simulation& simulation, ImageSize size) {
  const double radius = 0.0036 * static_cast<double>(size.height);
  const Camera camera = best_camera(simulation, size);
  const Samples samples = rasterize(*simulation.mesh, camera, size, Interior::hollow);
  Overview view{camera, shade(samples), {}};
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    std::vector<Tube> tubes;
    for (std::size_t s = 0; s < simulation.runs[r].strokes.size(); ++s) {
      for (Tube& tube : stroke_tubes(simulation, r, s, radius)) tubes.push_back(std::move(tube));
    }
    view.paths.push_back(draw_tubes(samples, camera, tubes));
  }
  return view;
}

std::vector<CloseUp> close_ups(const Simulation& simulation, const Moment& moment, ImageSize size) {
  const auto [camera, out] = close_camera(simulation, moment, size);
  std::vector<CloseUp> result;
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    result.push_back(close_up(simulation, r, moment, camera, out, size));
  }
  return result;
}

}  // namespace keepout::app
