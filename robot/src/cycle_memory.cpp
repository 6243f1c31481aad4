// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_memory.h"

#include <algorithm>
#include <limits>

#include "keepout/mesh/doctor.h"

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

/// The lengths that there are: of the ways from joint to joint, of what is carried, of the mesh.
double size_of(const Instrument& instrument, const Mesh& mesh) {
  double size = instrument.chain().base().position.norm() +
                mesh.bounds().low.cwiseAbs().cwiseMax(mesh.bounds().high.cwiseAbs()).norm();
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

CycleMemory::CycleMemory(const Instrument& its, Neighborhood& its_near, Solver& its_solver,
                         const InstrumentCapacity& capacity)
    : instrument(its),
      near(its_near),
      solver(its_solver),
      motion(its, its_near.budget()),
      rows(capacity.planes),
      earlier_rows(capacity.planes),
      warm(capacity.planes),
      earlier_warm(capacity.planes) {
  const auto n = static_cast<std::size_t>(its.chain().size());
  matrix.resize((2 * n + capacity.planes) * n);
  bounds.resize(2 * n + capacity.planes);
  solver.reserve(static_cast<int>(n), static_cast<int>(bounds.size()));
  is_watertight = keepout::is_watertight(near.mesh());
  prepare();
}

void CycleMemory::prepare() {
  const double size = size_of(instrument, near.mesh());
  largest_position = std::max(100.0 * size, 100.0);
  tolerance = 1e-12 * (size + std::min(instrument.chain().reach(), largest_position));
  bodies.clear();
  for (std::size_t b = 0; b < instrument.bodies().size(); ++b) {
    bodies.push_back({.near = NearSet(near.room(), reach_beyond_axis(instrument, b))});
  }
  forget();
}

void CycleMemory::forget() noexcept {
  forget_motion();
  for (BodyMemory& body : bodies) {
    body.near.forget();
    body.guard = 0.0;
  }
  forget_floors();
}

CycleMemory::Floors CycleMemory::floors() const noexcept {
  Floors all{};
  for (std::size_t b = 0; b < bodies.size(); ++b) all[b] = bodies[b].floor;
  for (std::size_t g = 0; g < guides.size(); ++g)
    all[Instrument::most_bodies + g] = guides[g].floor;
  return all;
}

void CycleMemory::set_floors(const Floors& all) noexcept {
  for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].floor = all[b];
  for (std::size_t g = 0; g < guides.size(); ++g)
    guides[g].floor = all[Instrument::most_bodies + g];
}

void CycleMemory::forget_floors() noexcept {
  for (BodyMemory& body : bodies) body.floor = std::numeric_limits<double>::infinity();
  for (GuideMemory& guide : guides) guide.floor = std::numeric_limits<double>::infinity();
}

void CycleMemory::forget_motion() noexcept {
  warm.clear();
  side_of = 0;
  for (BodyMemory& body : bodies) body.reach = 0.0;
}

}  // namespace keepout
