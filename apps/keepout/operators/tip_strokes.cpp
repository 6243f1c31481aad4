// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "keepout/error.h"
#include "keepout/fixtures/poses.h"
#include "operators/strokes.h"
#include "operators/tremor.h"
#include "shared/number_text.h"
#include "simulate/tool_audit.h"

namespace keepout::app {
namespace {

// Lengths for a mesh of at least 100 mm; smaller meshes scale them. Heights are those of a ball's
// center, or of the lowest point of a convex tool. [mm]
constexpr double start_height = 8.0;   // above the surface at both ends of a stroke
constexpr double deepest = 5.0;        // greatest depth of a goal below the surface
constexpr double slide_length = 30.0;  // longest slide over the surface
constexpr double tremor_amplitude = 0.1;

class TipStrokes {
 public:
  TipStrokes(Audit& audit, const StrokeSettings& settings, const ConvexTool* tool,
             std::vector<Guide> guides)
      : audit_(audit),
        tool_(tool),
        guides_(std::move(guides)),
        random_(settings.seed),
        cycles_(settings.cycles),
        scale_(std::min(1.0, audit.mesh().bounds().size().norm() / 100.0)) {}

  Stroke next() {
    const double height = start_height * scale_;
    const std::optional<SurfacePoint> start = place_to_start(height);
    if (!start) {
      throw Error("no free place to start a stroke from: there is no place with " +
                  trimmed(height) +
                  " mm of free space above the surface, on the side of its normals; if the normals "
                  "point into the solid, flip all triangles ('keepout inspect' reports it)");
    }
    const double lift = reach_against(start->normal);
    const double depth = random_.uniform(0.2, 1.0) * (deepest * scale_);
    const auto way = slide_over(*start, random_.uniform(0.3, 1.0) * (slide_length * scale_));
    const Tremor tremor(tremor_amplitude * scale_, random_);

    Stroke stroke;
    for (std::size_t cycle = 0; cycle < cycles_; ++cycle) {
      const double t = static_cast<double>(cycle) / static_cast<double>(cycles_);
      const double along = smooth((t - 0.25) / 0.5) * static_cast<double>(way.size() - 1);
      const auto station = std::min(static_cast<std::size_t>(along), way.size() - 2);
      const double blend = along - static_cast<double>(station);
      const Vec3 point = (1.0 - blend) * way[station].point + blend * way[station + 1].point;
      const Vec3 up = ((1.0 - blend) * way[station].normal + blend * way[station + 1].normal);
      const double above = lift + height - lowered(t) * (height + depth);
      const double seconds = static_cast<double>(cycle) * cycle_seconds;
      stroke.goals.push_back({.position = point + above * up + tremor.at(seconds)});
    }
    return stroke;
  }

 private:
  SurfacePoint on_surface(const Vec3& near) {
    const Hit hit = audit_.nearest(near);
    return {near + hit.closest.offset, audit_.mesh().normal(hit.triangle)};
  }

  SurfacePoint draw_place() {
    if (points_.empty()) points_ = surface_points(audit_.mesh(), 1000, 0.0, random_);
    const Vec3 point = points_.back();
    points_.pop_back();
    return on_surface(point);
  }

  /// Returns a place on the surface with free space above it. Prefers a place that faces outward: a
  /// stroke deep in a cavity would be as good a test, but invisible in a picture.
  std::optional<SurfacePoint> place_to_start(double height) {
    const Vec3 middle = audit_.mesh().bounds().center();
    std::array<std::optional<SurfacePoint>, 3> others;  // the better first
    for (int attempt = 0; attempt < 2000; ++attempt) {
      const SurfacePoint place = draw_place();
      const Vec3 outwards = place.point - middle;
      const bool faces_outwards = place.normal.dot(outwards) >= 0.3 * outwards.norm();
      const Vec3 start = place.point + (height + reach_against(place.normal)) * place.normal;
      const std::size_t rank = (is_guided(start) ? 0U : 2U) + (faces_outwards ? 0U : 1U);
      if (rank > 0 && others[rank - 1]) continue;
      if (!is_free(start, height)) continue;
      if (rank == 0) return place;
      others[rank - 1] = place;
    }
    for (const std::optional<SurfacePoint>& place : others) {
      if (place) return place;
    }
    return std::nullopt;
  }

  /// Returns how far the tool extends from its tip towards a surface with this normal. [length]
  double reach_against(const Vec3& normal) const {
    return tool_ == nullptr ? 0.0 : tool_->radius() + tool_->support(-normal).dot(-normal);
  }

  bool is_free(const Vec3& start, double height) {
    if (!(audit_.clearance(start) > 0.8 * height)) return false;
    if (tool_ == nullptr) return true;
    if (!tool_audit_) tool_audit_.emplace(audit_, *tool_, start);
    return tool_audit_->clearance_at(start, height) > 0.8 * height;
  }

  bool is_guided(const Vec3& start) const {
    return std::ranges::all_of(
        guides_, [&](const Guide& guide) { return guide.region().excess(start) <= 0.0; });
  }

  /// Returns places along the surface, in a direction that is straight as seen from above.
  std::vector<SurfacePoint> slide_over(const SurfacePoint& start, double length) {
    constexpr int stations = 16;
    std::vector<SurfacePoint> way{start};
    Vec3 heading = start.normal.cross(random_.direction()).normalized();
    for (int i = 1; i < stations; ++i) {
      const Vec3& up = way.back().normal;
      heading = (heading - up * up.dot(heading)).normalized();
      way.push_back(on_surface(way.back().point + heading * (length / (stations - 1))));
    }
    return way;
  }

  Audit& audit_;
  const ConvexTool* tool_;  // null for a ball
  std::vector<Guide> guides_;
  std::optional<ToolAudit> tool_audit_;
  Random random_;
  std::size_t cycles_;
  double scale_;  // of lengths
  std::vector<Vec3>
      points_;  // of the surface, many drawn at once, because each draw visits all triangles
};

}  // namespace

std::function<Stroke()> tip_strokes(Audit& audit, const StrokeSettings& settings,
                                    const ConvexTool* tool, std::vector<Guide> guides) {
  return [strokes = TipStrokes(audit, settings, tool, std::move(guides))]() mutable {
    return strokes.next();
  };
}

}  // namespace keepout::app
