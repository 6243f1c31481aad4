// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "keepout/fixtures/random.h"
#include "keepout/geometry/pose.h"
#include "verify/scene.h"

namespace keepout::app {
namespace {

constexpr double radius = 20.0;           // [mm]
constexpr std::size_t most_columns = 16;  // of a grid of up to 12 rings: 368 triangles

Surface soup(Random& random) {
  Surface surface;
  const std::size_t count = 20 + random.below(380);
  for (std::size_t t = 0; t < count; ++t) {
    const Vec3 place = radius * std::cbrt(random.uniform()) * random.direction();
    const double size = 10.0 * std::pow(10.0, random.uniform(-1.5, 0.0));
    const auto first = static_cast<VertexId>(surface.vertices.size());
    for (int i = 0; i < 3; ++i) surface.vertices.push_back(place + size * random.direction());
    surface.triangles.push_back({first, first + 1, first + 2});
  }
  return surface;
}

/// Returns a height field over a disk: rings around a center vertex, the outermost at the radius.
template <class Height>
Surface disk(std::size_t rings, std::size_t columns, const Height& height) {
  Surface surface;
  surface.vertices.emplace_back(0.0, 0.0, height(0.0, 0.0));
  for (std::size_t r = 1; r <= rings; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      const double angle =
          2.0 * std::numbers::pi * static_cast<double>(c) / static_cast<double>(columns);
      const double out = radius * static_cast<double>(r) / static_cast<double>(rings);
      const double x = out * std::cos(angle);
      const double y = out * std::sin(angle);
      surface.vertices.emplace_back(x, y, height(x, y));
    }
  }
  const auto vertex = [columns](std::size_t ring, std::size_t column) {
    return static_cast<VertexId>(ring == 0 ? 0 : 1 + (ring - 1) * columns + column % columns);
  };
  for (std::size_t r = 1; r <= rings; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      surface.triangles.push_back({vertex(r - 1, c), vertex(r, c), vertex(r, c + 1)});
      if (r == 1) continue;
      surface.triangles.push_back({vertex(r - 1, c), vertex(r, c + 1), vertex(r - 1, c + 1)});
    }
  }
  return surface;
}

Surface fan(Random& random) {
  const std::size_t columns = 2 * (3 + random.below(60));
  const double slope = random.uniform(0.1, 2.0);
  Surface surface = disk(1, columns, [](double, double) { return 0.0; });
  for (std::size_t c = 0; c < columns; ++c) {
    surface.vertices[1 + c].z() = slope * radius * (c % 2 == 0 ? 1.0 : -random.uniform());
  }
  return surface;
}

Surface cone(Random& random) {
  const double slope = std::pow(10.0, random.uniform(-1.0, 0.5));
  const std::size_t columns = 8 + random.below(392);
  return disk(1, columns, [&](double x, double y) { return -slope * std::hypot(x, y); });
}

Surface bowl(Random& random) {
  const double depth = random.uniform(0.2, 1.5) / radius;
  return disk(4 + random.below(8), most_columns,
              [&](double x, double y) { return depth * (x * x + y * y); });
}

Surface saddle(Random& random) {
  const double depth = random.uniform(0.2, 1.0) / radius;
  return disk(4 + random.below(8), most_columns,
              [&](double x, double y) { return depth * (x * x - y * y); });
}

Surface sheets(Random& random) {
  Surface surface;
  const std::size_t count = 2 + random.below(3);
  for (std::size_t s = 0; s < count; ++s) {
    // Each sheet has its own triangulation.
    const Surface sheet = disk(1 + random.below(4), 8 + random.below(6),
                               [&](double, double) { return 1e-9 * static_cast<double>(s); });
    const auto first = static_cast<VertexId>(surface.vertices.size());
    surface.vertices.insert(surface.vertices.end(), sheet.vertices.begin(), sheet.vertices.end());
    for (const auto& [a, b, c] : sheet.triangles) {
      surface.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return surface;
}

}  // namespace

std::vector<Arena> hostile_arenas(const std::string& index) {
  using Make = Surface (*)(Random&);
  constexpr std::array<std::pair<const char*, Make>, 6> kinds{{{"soup", soup},
                                                               {"fan", fan},
                                                               {"sheets", sheets},
                                                               {"cone", cone},
                                                               {"bowl", bowl},
                                                               {"saddle", saddle}}};
  std::vector<Arena> arenas;
  for (const auto& [name, make] : kinds) {
    arenas.push_back(
        {.mesh = name, .draw = [name, make, index](Random& random) {
           Surface surface = make(random);
           const Mat3 turn =
               Eigen::AngleAxisd(random.uniform(0.0, 3.0), random.direction()).toRotationMatrix();
           for (Vec3& vertex : surface.vertices) vertex = turn * vertex;
           return std::make_shared<Scene>(name, std::move(surface), index);
         }});
  }
  return arenas;
}

}  // namespace keepout::app
