// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_memory.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "keepout/activation/tolerances.h"
#include "keepout/error.h"
#include "keepout/option_table.h"

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
    const double fraction =
        length2 > 0.0 ? std::clamp(along.dot(point.position - a) / length2, 0.0, 1.0) : 0.0;
    most = std::max(most, (point.position - a - fraction * along).norm());
  }
  return most * (1.0 + 1e-12);
}

/// Returns a distance from the origin that no point of the mesh exceeds. [length]
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

CycleMemory::CycleMemory(const Instrument& of, Solver& its_solver,
                         const InstrumentCapacity& capacity)
    : instrument(of),
      trial_motion(of, budget),
      rows(capacity.planes),
      earlier_rows(capacity.planes),
      warm(capacity.planes),
      solver(its_solver) {
  const auto n = static_cast<std::size_t>(of.chain().size());
  bounds.resize(2 * n + capacity.planes);
  matrix.resize(bounds.size() * n);
  solver.reserve(of.chain().size(), static_cast<int>(bounds.size()));
}

void CycleMemory::prepare() {
  std::vector<PairMemory> all;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    for (std::size_t b = 0; b < instrument.bodies().size(); ++b) {
      const std::size_t capacity = meshes[m].neighborhood->room();
      all.push_back({.body = b,
                     .mesh = m,
                     .triangles = NearSet(capacity, distance_beyond_axis(instrument, b))});
    }
  }
  obstacles.resize(all.size());
  pairs = std::move(all);
  forget();
}

void CycleMemory::measure() noexcept {
  double size = size_of(instrument, 0.0);
  double size_with_poses = size;
  for (const MeshMemory& mesh : meshes) {
    const double own = size_of(instrument, extent_of(mesh.neighborhood->mesh()));
    size = std::max(size, own);
    size_with_poses = std::max(size_with_poses, own + mesh.pose.position.norm());
  }
  largest_length = 100.0 * size;
  tolerance = 1e-12 * (size_with_poses + std::min(instrument.chain().reach(), largest_length));
}

double CycleMemory::least_margin(const InstrumentOptions& options) const noexcept {
  double margin = options.margin;
  for (const MeshMemory& mesh : meshes) margin = std::min(margin, mesh.margin(options));
  return margin;
}

bool CycleMemory::is_lost_in_rounding(const InstrumentOptions& options) const noexcept {
  const double least = needed_band * tolerance;
  return !(least_margin(options) - options.band > least) || !(options.band > least) ||
         std::any_of(guides.begin(), guides.end(), [&](const GuideMemory& each) {
           return !(each.guide.band() > needed_band * tolerance_of(each.guide, tolerance));
         });
}

void CycleMemory::require_usable(const InstrumentOptions& o) const {
  require_in_range(instrument_options, o);
  for (const MeshMemory& mesh : meshes) {
    InstrumentOptions beside = o;
    beside.margin = mesh.margin(o);
    require_in_range(instrument_options, beside);
  }
  const double margin = least_margin(o);
  if (!(o.band < margin)) {
    throw Error("band: expected less than the margin of each mesh, of which the least is " +
                text_of(margin) + ", got " + text_of(o.band));
  }
  const double least = needed_band * tolerance;
  const std::string lost = ", or it is lost in the rounding of lengths this large; got ";
  if (!(o.band > least)) {
    throw Error("band: expected more than " + text_of(least) + lost + text_of(o.band));
  }
  if (!(margin - o.band > least)) {
    throw Error("margin: expected more than " + text_of(o.band + least) + lost + text_of(margin));
  }
  for (const GuideMemory& each : guides) require_not_lost(each.guide);
}

void CycleMemory::require_not_lost(const Guide& guide) const {
  const double least = needed_band * tolerance_of(guide, tolerance);
  if (guide.band() > least) return;
  throw Error("the band of guide '" + guide.name() + "' must be more than " + text_of(least) +
              ", or it is lost in the rounding of lengths this large; got " +
              text_of(guide.band()));
}

void CycleMemory::set_guides(std::vector<Guide> all) {
  if (all.size() > Guide::most) {
    throw Error("an instrument has at most " + std::to_string(Guide::most) + " guides, not " +
                std::to_string(all.size()));
  }
  const int links = instrument.chain().size();
  for (const Guide& guide : all) {
    require_not_lost(guide);
    if (guide.link() == 0) {
      throw Error(
          "guide '" + guide.name() +
          "' is for a tip, or on link 0, the base, which no joint moves: name a link of the "
          "chain, as in Guide.point(name, link, position, region)");
    }
    if (guide.link() <= links) continue;
    throw Error("guide '" + guide.name() + "' is on link " + std::to_string(guide.link()) +
                "; there are links 0 to " + std::to_string(links));
  }
  guides.clear();
  for (Guide& guide : all) {
    guides.push_back({std::move(guide), -std::numeric_limits<double>::infinity()});
  }
  guide_states.assign(guides.size(), {});
  forget_motion();
}

void CycleMemory::forget() noexcept {
  forget_motion();
  for (PairMemory& pair : pairs) {
    pair.triangles.forget();
    pair.padding = 0.0;
  }
  forget_certified();
}

CycleMemory::Certified CycleMemory::certified() const noexcept {
  Certified all{};
  for (std::size_t p = 0; p < pairs.size(); ++p) all[p] = pairs[p].certified;
  for (std::size_t g = 0; g < guides.size(); ++g) {
    all[owner_of_guide(g)] = guides[g].certified;
  }
  return all;
}

void CycleMemory::set_certified(const Certified& all) noexcept {
  for (std::size_t p = 0; p < pairs.size(); ++p) pairs[p].certified = all[p];
  for (std::size_t g = 0; g < guides.size(); ++g) {
    guides[g].certified = all[owner_of_guide(g)];
  }
}

void CycleMemory::forget_certified() noexcept {
  Certified unknown;
  unknown.fill(-std::numeric_limits<double>::infinity());
  set_certified(unknown);
}

void CycleMemory::forget_motion() noexcept {
  warm.clear();
  for (MeshMemory& mesh : meshes) mesh.sides.forget();
  for (PairMemory& pair : pairs) {
    pair.displacement = 0.0;
    pair.may_have_crossed = false;  // sides.forget() has made all sides unknown
  }
}

}  // namespace keepout
