// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_memory.h"

#include <algorithm>
#include <limits>

namespace keepout {
namespace {

double reach_beyond_axis(const Instrument& instrument, std::size_t body) {
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

/// Returns the lengths at hand but for where the mesh is: of the ways from joint to joint, of what
/// is carried, of the mesh. [length]
double size_of(const Instrument& instrument, const Mesh& mesh) {
  const Box bounds = mesh.bounds();
  double size = instrument.chain().base().position.norm() +
                bounds.low.cwiseAbs().cwiseMax(bounds.high.cwiseAbs()).norm();
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

CycleMemory::CycleMemory(const Instrument& its, Solver& its_solver,
                         const InstrumentCapacity& capacity)
    : instrument(its),
      solver(its_solver),
      motion(its, budget),
      rows(capacity.planes),
      earlier_rows(capacity.planes),
      warm(capacity.planes),
      earlier_warm(capacity.planes) {
  const auto n = static_cast<std::size_t>(its.chain().size());
  matrix.resize((2 * n + capacity.planes) * n);
  bounds.resize(2 * n + capacity.planes);
  solver.reserve(static_cast<int>(n), static_cast<int>(bounds.size()));
}

void CycleMemory::prepare() {
  pairs.clear();
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    for (std::size_t b = 0; b < instrument.bodies().size(); ++b) {
      pairs.push_back({.body = b,
                       .mesh = m,
                       .near = NearSet(meshes[m].near->room(), reach_beyond_axis(instrument, b))});
    }
  }
  measure();
  forget();
}

void CycleMemory::measure() noexcept {
  double size = 0.0;
  double size_with_poses = 0.0;
  for (const MeshMemory& mesh : meshes) {
    const double own = size_of(instrument, mesh.near->mesh());
    size = std::max(size, own);
    size_with_poses = std::max(size_with_poses, own + mesh.pose.position.norm());
  }
  largest_position = 100.0 * size;
  tolerance = 1e-12 * (size_with_poses + std::min(instrument.chain().reach(), largest_position));
}

bool CycleMemory::is_lost_in_rounding(const InstrumentOptions& options) const noexcept {
  double margin = options.margin;
  for (const MeshMemory& mesh : meshes) margin = std::min(margin, mesh.margin(options));
  // The certified distance, and the band, are told apart from rounding.
  const double least = 4.0 * tolerance;
  return !(margin - options.band > least) || !(options.band > least) ||
         std::any_of(guides.begin(), guides.end(), [&](const GuideMemory& each) {
           return !(each.guide.band() > 4.0 * tolerance_of(each.guide));
         });
}

void CycleMemory::forget() noexcept {
  forget_motion();
  for (PairMemory& pair : pairs) {
    pair.near.forget();
    pair.guard = 0.0;
  }
  forget_floors();
}

CycleMemory::Floors CycleMemory::floors() const noexcept {
  Floors all{};
  for (std::size_t p = 0; p < pairs.size(); ++p) all[p] = pairs[p].floor;
  for (std::size_t g = 0; g < guides.size(); ++g) all[most_pairs + g] = guides[g].floor;
  return all;
}

void CycleMemory::set_floors(const Floors& all) noexcept {
  for (std::size_t p = 0; p < pairs.size(); ++p) pairs[p].floor = all[p];
  for (std::size_t g = 0; g < guides.size(); ++g) guides[g].floor = all[most_pairs + g];
}

void CycleMemory::forget_floors() noexcept {
  for (PairMemory& pair : pairs) pair.floor = -std::numeric_limits<double>::infinity();
  for (GuideMemory& guide : guides) guide.floor = -std::numeric_limits<double>::infinity();
}

void CycleMemory::forget_motion() noexcept {
  warm.clear();
  for (MeshMemory& mesh : meshes) mesh.side_of = 0;
  for (PairMemory& pair : pairs) {
    pair.reach = 0.0;
    pair.is_side_unknown = false;  // as it is of all, by side_of
  }
}

}  // namespace keepout
