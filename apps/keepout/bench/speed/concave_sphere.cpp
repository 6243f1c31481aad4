// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "bench/speed/certified_contact.h"
#include "bench/speed/families.h"
#include "keepout/fixtures/shapes.h"

namespace keepout::app {
namespace {

/// A sphere of radius 50, its normals to the centre, of about so many triangles.
IndexedMesh hollow(std::size_t triangles) {
  constexpr double icosahedron = 52.57;  // its edge, for that radius [mm]
  const double edge = icosahedron / std::sqrt(static_cast<double>(triangles) / 20.0);
  return with_index(std::make_shared<const Mesh>(in_single_precision(make_concave_sphere(edge))));
}

/// Back and forth around the centre, where all triangles are equally far.
std::vector<Motion> motions_at_the_centre(std::size_t count, Random random) {
  std::vector<Motion> motions;
  constexpr double nearness = 1.0;  // [mm]
  Vec3 tip = Vec3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 step = random.uniform(0.05, 0.2) * random.direction();
    const Vec3 desired = (tip + step).norm() < nearness ? step : Vec3(-step);
    motions.push_back({.tip = tip, .desired = desired});
    tip += desired;
    if (tip.norm() > nearness) tip = Vec3::Zero();
  }
  return motions;
}

}  // namespace

void measure_concave_sphere(SpeedRun& run) {
  run.show("concave sphere");
  const IndexedMesh sphere = hollow(run.settings.triangles);
  const CertifiedSide centre =
      time_certified(run, sphere, "centre", small_margin,
                     motions_at_the_centre(run.settings.effort.steps, run.random()));
  run.add(with_remark(ratio("certified in a concave sphere", "tip at the centre / free space",
                            at_most(3.0), centre.side, run.baselines.free),
                      centre));
  CertifiedSide wall = in_contact(run, sphere, {});
  if (wall.side) wall.side->name = "wall";
  run.add(with_remark(ratio("certified in a concave sphere", "tip at the wall / contact",
                            at_most(6.0), wall.side, run.baselines.contact),
                      wall));
}

}  // namespace keepout::app
