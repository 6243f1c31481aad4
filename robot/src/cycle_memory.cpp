// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_memory.h"

#include <algorithm>
#include <limits>

#include "keepout/activation/tolerances.h"
#include "keepout/error.h"

namespace keepout {
namespace {

/// Returns the largest distance of a body's points from the segment of its first two. [length]
double distance_beyond_axis(const Instrument& instrument, std::size_t body) {
  const std::vector<LinkPoint>& points = instrument.bodies()[body].points;
  if (points.size() < 3) return 0.0;
  const Vec3& a = points[0].position;
  const Vec3 along = points[1].position - a;
  const double length2 = along.squaredNorm();
  double most = 0.0;
  for (const LinkPoint& point : points) {
    const double share =
        length2 > 0.0 ? std::clamp(along.dot(point.position - a) / length2, 0.0, 1.0) : 0.0;
    most = std::max(most, (point.position - a - share * along).norm());
  }
  return most * (1.0 + 1e-12);
}

/// Returns the distance from the origin within which the mesh is. [length]
double extent_of(const Mesh& mesh) {
  const Box bounds = mesh.bounds();
  return bounds.low.cwiseAbs().cwiseMax(bounds.high.cwiseAbs()).norm();
}

/// Returns the sum of the lengths of the chain, the instrument and a mesh, without the pose of the
/// mesh. [length]
double size_of(const Instrument& instrument, double extent_of_mesh) {
  double size = instrument.chain().base().position.norm() + extent_of_mesh;
  for (int k = 1; k <= instrument.chain().size(); ++k) {
    size += instrument.chain().joint(k).origin.position.norm();
  }
  double carried = 0.0;
  for (const LinkPoint& point : instrument.points()) {
    carried = std::max(carried, point.position.norm());
  }
  return size + carried;
}

}  // namespace

CycleMemory::CycleMemory(const Instrument& of, Solver& solver, const InstrumentCapacity& capacity)
    : instrument(of),
      motion(of, budget),
      rows(capacity.planes),
      problem(solver, of.chain().size(), capacity.planes) {}

void CycleMemory::prepare() {
  bodies.pairs.clear();
  for (std::size_t m = 0; m < bodies.meshes.size(); ++m) {
    for (std::size_t b = 0; b < instrument.bodies().size(); ++b) {
      const std::size_t capacity = bodies.meshes[m].neighborhood->room();
      bodies.pairs.push_back({.body = b,
                              .mesh = m,
                              .triangles = NearSet(capacity, distance_beyond_axis(instrument, b))});
    }
  }
  obstacles.resize(bodies.pairs.size());
  measure();
  forget();
}

void CycleMemory::measure() noexcept {
  double size = size_of(instrument, 0.0);
  double size_with_poses = size;
  for (const MeshMemory& mesh : bodies.meshes) {
    const double own = size_of(instrument, extent_of(mesh.neighborhood->mesh()));
    size = std::max(size, own);
    size_with_poses = std::max(size_with_poses, own + mesh.pose.position.norm());
  }
  largest_position = 100.0 * size;
  tolerance = 1e-12 * (size_with_poses + std::min(instrument.chain().reach(), largest_position));
}

double CycleMemory::least_margin(const InstrumentOptions& options) const noexcept {
  double margin = options.margin;
  for (const MeshMemory& mesh : bodies.meshes) margin = std::min(margin, mesh.margin(options));
  return margin;
}

bool CycleMemory::is_lost_in_rounding(const InstrumentOptions& options) const noexcept {
  const double least = needed_band * tolerance;
  return !(least_margin(options) - options.band > least) || !(options.band > least) ||
         std::any_of(guides.guides.begin(), guides.guides.end(), [&](const GuideMemory& each) {
           return !(each.guide.band() > needed_band * tolerance_of(each.guide, tolerance));
         });
}

void CycleMemory::require_usable(const InstrumentOptions& o) const {
  require_in_range(instrument_options, o);
  for (const MeshMemory& mesh : bodies.meshes) {
    InstrumentOptions beside = o;
    beside.margin = mesh.margin(o);
    require_in_range(instrument_options, beside);
  }
  if (!(o.band < least_margin(o))) throw Error("the band must be below the margin of each mesh");
  if (is_lost_in_rounding(o)) {
    throw Error(
        "the margin, its band or a guide's band is lost in the rounding of an instrument and a "
        "mesh of this size: each must be well above 1e-11 of both");
  }
}

void CycleMemory::forget() noexcept {
  forget_motion();
  for (PairMemory& pair : bodies.pairs) {
    pair.triangles.forget();
    pair.padding = 0.0;
  }
  forget_certified();
}

CycleMemory::Certified CycleMemory::certified() const noexcept {
  Certified all{};
  for (std::size_t p = 0; p < bodies.pairs.size(); ++p) all[p] = bodies.pairs[p].certified;
  for (std::size_t g = 0; g < guides.guides.size(); ++g) {
    all[owner_of_guide(g)] = guides.guides[g].certified;
  }
  return all;
}

void CycleMemory::set_certified(const Certified& all) noexcept {
  for (std::size_t p = 0; p < bodies.pairs.size(); ++p) bodies.pairs[p].certified = all[p];
  for (std::size_t g = 0; g < guides.guides.size(); ++g) {
    guides.guides[g].certified = all[owner_of_guide(g)];
  }
}

void CycleMemory::forget_certified() noexcept {
  Certified unknown;
  unknown.fill(-std::numeric_limits<double>::infinity());
  set_certified(unknown);
}

void CycleMemory::forget_motion() noexcept {
  rows.warm.clear();
  for (MeshMemory& mesh : bodies.meshes) mesh.sides.forget();
  for (PairMemory& pair : bodies.pairs) {
    pair.displacement = 0.0;
    pair.may_have_crossed = false;  // sides.forget() has made all sides unknown
  }
}

}  // namespace keepout
