// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "plan/free_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout::app {
namespace {

constexpr float not_looked_at = -1.0F;
constexpr float not_free = -2.0F;

std::uint32_t count(double length, double spacing) {
  return 1 + static_cast<std::uint32_t>(std::floor(length / spacing));
}

std::uint32_t difference(std::uint32_t a, std::uint32_t b) noexcept {
  return a > b ? a - b : b - a;
}

}  // namespace

FreeCells::Place FreeCells::place(Cell cell) const noexcept {
  return {cell % nx_, cell / nx_ % ny_, cell / nx_ / ny_};
}

Vec3 FreeCells::center(Cell cell) const noexcept {
  const Place p = place(cell);
  return low_ + spacing_ * Vec3(p.x, p.y, p.z);
}

template <class Visit>
void FreeCells::for_each_neighbor(Cell cell, const Visit& visit) const {
  const Place p = place(cell);
  if (p.x > 0) visit(cell - 1);
  if (p.x + 1 < nx_) visit(cell + 1);
  if (p.y > 0) visit(cell - nx_);
  if (p.y + 1 < ny_) visit(cell + nx_);
  if (p.z > 0) visit(cell - nx_ * ny_);
  if (p.z + 1 < nz_) visit(cell + nx_ * ny_);
}

FreeCells::FreeCells(Scene& scene, const Box& bounds, double spacing, double clearance, double told,
                     const Vec3& from)
    : low_(bounds.low),
      spacing_(spacing),
      nx_(count(bounds.size().x(), spacing)),
      ny_(count(bounds.size().y(), spacing)),
      nz_(count(bounds.size().z(), spacing)),
      distance_(std::size_t{nx_} * ny_ * nz_, not_looked_at) {
  const double needed = clearance + 0.5 * spacing;
  const double reach = std::max(needed, told);
  TriangleBuffer candidates(scene.mesh()->triangle_count());
  const auto distance_of = [&](const Vec3& point, double guess) {
    candidates.clear();
    scene.index().collect({point, reach}, candidates);  // far off, as most are: soon told
    if (candidates.view().empty()) return std::numeric_limits<double>::infinity();
    return scene.nearest(point, std::min(guess, reach)).closest.distance;
  };
  const auto look = [&](Cell cell, double guess) {
    if (distance_[cell] != not_looked_at) return;
    const double distance = distance_of(center(cell), guess);
    distance_[cell] = distance >= needed ? static_cast<float>(distance) : not_free;
    if (distance >= needed) reached_.push_back(cell);
  };
  const Vec3 at = ((from - low_) / spacing).array().round();
  const auto clamped = [](double value, std::uint32_t size) {
    return static_cast<std::uint32_t>(std::clamp(value, 0.0, static_cast<double>(size - 1)));
  };
  look(clamped(at.x(), nx_) + nx_ * (clamped(at.y(), ny_) + ny_ * clamped(at.z(), nz_)), 0.0);
  for (std::size_t i = 0; i < reached_.size(); ++i) {
    const double guess = distance_[reached_[i]] + spacing;
    for_each_neighbor(reached_[i], [&](Cell next) { look(next, guess); });
  }
}

std::vector<std::uint32_t> FreeCells::steps_from(Cell cell) const {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> steps(distance_.size(), none);
  std::vector<Cell> queue{cell};
  steps[cell] = 0;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    for_each_neighbor(queue[i], [&](Cell next) {
      if (distance_[next] < 0.0F || steps[next] != none) return;
      steps[next] = steps[queue[i]] + 1;
      queue.push_back(next);
    });
  }
  return steps;
}

std::uint32_t FreeCells::steps_in_the_open(Cell a, Cell b) const noexcept {
  const Place p = place(a);
  const Place q = place(b);
  return difference(p.x, q.x) + difference(p.y, q.y) + difference(p.z, q.z);
}

}  // namespace keepout::app
