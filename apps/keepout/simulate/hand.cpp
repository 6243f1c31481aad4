// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/hand.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "keepout/error.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/random.h"
#include "shared/number_text.h"
#include "simulate/tremor.h"

namespace keepout::app {
namespace {

// On a mesh of 100 mm and more; on a smaller one the hand is as much smaller. [mm]
constexpr double start_height = 8.0;   // above the surface at both ends of a stroke
constexpr double deepest = 5.0;        // how far below the surface the hand aims, at most
constexpr double slide_length = 30.0;  // over the surface, at most
constexpr double tremor_amplitude = 0.1;

struct SurfacePlace {
  Vec3 point;
  Vec3 normal;
};

SurfacePlace on_surface(Audit& audit, const Vec3& near) {
  const Hit hit = audit.nearest(near);
  return {near + hit.closest.offset, audit.mesh().normal(hit.triangle)};
}

/// Places all over the surface, drawn many at a time: each draw goes over all triangles once.
class Places {
 public:
  Places(Audit& audit, Random& random) : audit_(audit), random_(random) {}

  SurfacePlace next() {
    if (points_.empty()) points_ = surface_points(audit_.mesh(), 1000, 0.0, random_);
    const Vec3 point = points_.back();
    points_.pop_back();
    return on_surface(audit_, point);
  }

 private:
  Audit& audit_;
  Random& random_;
  std::vector<Vec3> points_;
};

/// A place on the surface with free room above it; if there are such, one that faces outwards:
/// strokes deep in a cavity would be as good a test, but nobody could see them in a picture.
std::optional<SurfacePlace> place_to_start(Audit& audit, Places& places, double height) {
  const Vec3 middle = audit.mesh().bounds().center();
  const auto is_free = [&](const SurfacePlace& place) {
    return audit.clearance(place.point + height * place.normal) > 0.8 * height;
  };
  std::optional<SurfacePlace> facing_elsewhere;
  for (int attempt = 0; attempt < 2000; ++attempt) {
    const SurfacePlace place = places.next();
    const Vec3 outwards = place.point - middle;
    const bool faces_outwards = place.normal.dot(outwards) >= 0.3 * outwards.norm();
    if (faces_outwards && is_free(place)) return place;
    if (!faces_outwards && !facing_elsewhere && is_free(place)) facing_elsewhere = place;
  }
  return facing_elsewhere;
}

/// Follows the surface from a place, in a straight direction as seen from above.
std::vector<SurfacePlace> slide_over(Audit& audit, const SurfacePlace& start, double length,
                                     Random& random) {
  constexpr int stations = 16;
  std::vector<SurfacePlace> way{start};
  Vec3 heading = start.normal.cross(random.direction()).normalized();
  for (int i = 1; i < stations; ++i) {
    const Vec3& up = way.back().normal;
    heading = (heading - up * up.dot(heading)).normalized();
    way.push_back(on_surface(audit, way.back().point + heading * (length / (stations - 1))));
  }
  return way;
}

/// `scale`: of the lengths.
std::vector<Vec3> make_stroke(Audit& audit, std::size_t cycles, double scale, Places& places,
                              Random& random) {
  const double height = start_height * scale;
  const std::optional<SurfacePlace> start = place_to_start(audit, places, height);
  if (!start) {
    throw Error("no free place to start a stroke from: nowhere is there room for " +
                trimmed(height) +
                " mm above the surface, on the side that its normals point to; if they point into "
                "the solid, flip all triangles ('keepout inspect' tells whether they do)");
  }
  const double depth = random.uniform(0.2, 1.0) * (deepest * scale);
  const std::vector<SurfacePlace> way =
      slide_over(audit, *start, random.uniform(0.3, 1.0) * (slide_length * scale), random);
  const Tremor tremor(tremor_amplitude * scale, random);

  std::vector<Vec3> hand;
  for (std::size_t cycle = 0; cycle < cycles; ++cycle) {
    const double t = static_cast<double>(cycle) / static_cast<double>(cycles);
    const double along = smooth((t - 0.25) / 0.5) * static_cast<double>(way.size() - 1);
    const auto station = std::min(static_cast<std::size_t>(along), way.size() - 2);
    const double blend = along - static_cast<double>(station);
    const Vec3 point = (1.0 - blend) * way[station].point + blend * way[station + 1].point;
    const Vec3 up = ((1.0 - blend) * way[station].normal + blend * way[station + 1].normal);
    const double lowered = smooth(t / 0.25) * smooth((1.0 - t) / 0.25);
    const double above = height - lowered * (height + depth);
    const double seconds = static_cast<double>(cycle) * cycle_seconds;
    hand.push_back(point + above * up + tremor.at(seconds));
  }
  return hand;
}

}  // namespace

std::vector<std::vector<Vec3>> make_hand(Audit& audit, const HandSettings& settings) {
  Random random(settings.seed);
  const double scale = std::min(1.0, audit.mesh().bounds().size().norm() / 100.0);
  Places places(audit, random);
  std::vector<std::vector<Vec3>> strokes;
  while (strokes.size() < settings.strokes) {
    strokes.push_back(make_stroke(audit, settings.cycles, scale, places, random));
  }
  return strokes;
}

}  // namespace keepout::app
