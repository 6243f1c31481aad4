// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "hand.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "keepout/error.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/random.h"

namespace keepout::app {
namespace {

struct SurfacePoint {
  Vec3 point;
  Vec3 normal;
};

SurfacePoint on_surface(Audit& audit, const Vec3& near) {
  const Hit hit = audit.nearest(near);
  return {near + hit.closest.offset, audit.mesh().normal(hit.triangle)};
}

/// A place on the surface with free room above it, on the side that faces outwards: strokes deep in
/// a cavity would be as good a test, but nobody could see them in a picture.
std::optional<SurfacePoint> place_to_start(Audit& audit, double height, Random& random) {
  const Vec3 middle = audit.mesh().bounds().center();
  for (int attempt = 0; attempt < 2000; ++attempt) {
    const SurfacePoint place =
        on_surface(audit, surface_points(audit.mesh(), 1, 0.0, random).front());
    const Vec3 outwards = place.point - middle;
    if (place.normal.dot(outwards) < 0.3 * outwards.norm()) continue;
    if (audit.clearance(place.point + height * place.normal) > 0.8 * height) return place;
  }
  return std::nullopt;
}

/// From 0 to 1 with no jerk at either end.
double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// A smooth shake of three incommensurable waves along each axis.
class Tremor {
 public:
  Tremor(double amplitude, Random& random) : amplitude_(amplitude) {
    for (Wave& wave : waves_) {
      wave = {random.direction(), random.uniform(8.0, 12.0), random.uniform(0.0, 1.0)};
    }
  }

  Vec3 at(double seconds) const {
    Vec3 sum = Vec3::Zero();
    for (const Wave& wave : waves_) {
      sum += wave.direction *
             std::sin(2.0 * std::numbers::pi * (wave.frequency * seconds + wave.phase));
    }
    return amplitude_ / std::sqrt(3.0) * sum;
  }

 private:
  struct Wave {
    Vec3 direction;
    double frequency;  // [Hz]
    double phase;      // [turns]
  };
  double amplitude_;
  std::array<Wave, 3> waves_;
};

/// Follows the surface from a place, in a straight direction as seen from above.
std::vector<SurfacePoint> slide_over(Audit& audit, const SurfacePoint& start, double length,
                                     Random& random) {
  constexpr int stations = 16;
  std::vector<SurfacePoint> way{start};
  Vec3 heading = start.normal.cross(random.direction()).normalized();
  for (int i = 1; i < stations; ++i) {
    const Vec3& up = way.back().normal;
    heading = (heading - up * up.dot(heading)).normalized();
    way.push_back(on_surface(audit, way.back().point + heading * (length / (stations - 1))));
  }
  return way;
}

std::vector<Vec3> make_stroke(Audit& audit, const HandSettings& settings, double height,
                              Random& random) {
  const std::optional<SurfacePoint> start = place_to_start(audit, height, random);
  if (!start) {
    throw Error(
        "the mesh offers no free place to start a stroke from; is it inside out? See "
        "'keepout inspect'");
  }
  const double depth = random.uniform(0.2, 1.0) * settings.deepest;
  const std::vector<SurfacePoint> way =
      slide_over(audit, *start, random.uniform(0.3, 1.0) * settings.slide_length, random);
  const Tremor tremor(settings.tremor, random);

  std::vector<Vec3> hand;
  for (std::size_t cycle = 0; cycle < settings.cycles; ++cycle) {
    const double t = static_cast<double>(cycle) / static_cast<double>(settings.cycles);
    const double along = smooth((t - 0.25) / 0.5) * static_cast<double>(way.size() - 1);
    const auto station = std::min(static_cast<std::size_t>(along), way.size() - 2);
    const double blend = along - static_cast<double>(station);
    const Vec3 point = (1.0 - blend) * way[station].point + blend * way[station + 1].point;
    const Vec3 up = ((1.0 - blend) * way[station].normal + blend * way[station + 1].normal);
    const double lowered = smooth(t / 0.25) * smooth((1.0 - t) / 0.25);
    const double above = height - lowered * (height + depth);
    const double seconds = static_cast<double>(cycle) * settings.cycle_seconds;
    hand.push_back(point + above * up + tremor.at(seconds));
  }
  return hand;
}

}  // namespace

std::vector<std::vector<Vec3>> make_hand(Audit& audit, const HandSettings& settings) {
  Random random(settings.seed);
  // On a small mesh the hand is as much smaller.
  const double size = audit.mesh().bounds().size().norm();
  HandSettings scaled = settings;
  const double scale = std::min(1.0, size / 100.0);
  scaled.deepest *= scale;
  scaled.slide_length *= scale;
  scaled.tremor *= scale;
  std::vector<std::vector<Vec3>> strokes;
  while (strokes.size() < settings.strokes) {
    strokes.push_back(make_stroke(audit, scaled, settings.start_height * scale, random));
  }
  return strokes;
}

}  // namespace keepout::app
