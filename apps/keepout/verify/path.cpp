// SPDX-License-Identifier: BSD-3-Clause
#include "path.h"

#include <algorithm>
#include <cmath>

#include "shared/clip.h"

namespace keepout::app {

Path::Path(Scene& scene, Random& random, const Setup& setup)
    : scene_(&scene),
      random_(&random),
      route_(setup.route),
      longest_(setup.longest_step),
      kept_(required_clearance(setup.options)),
      period_(10 + random.below(110)),
      has_all_lengths_(random.uniform() < 0.4) {
  const bool is_watchful = route_ == Route::aim || route_ == Route::slide;
  attention_ = is_watchful ? 4 + random.below(12) : 64;
}

void Path::look(const Vec3& tip) {
  const Hit hit = scene_->nearest(tip, guess_);
  guess_ = 1.1 * hit.closest.distance;
  triangle_ = hit.triangle;
  inwards_ = hit.closest.distance > 0.0 ? Vec3(hit.closest.offset / hit.closest.distance)
                                        : random_->direction();
}

/// A corner of the nearest triangle, the middle of an edge, or the centre.
Vec3 Path::target_on_triangle() const {
  const Triangle c = scene_->mesh()->triangle(triangle_);
  const std::size_t corner = random_->below(3);
  switch (random_->below(5)) {
    case 0:
    case 1:
      return c[corner];
    case 2:
    case 3:
      return 0.5 * (c[corner] + c[(corner + 1) % 3]);
    default:
      return (c[0] + c[1] + c[2]) / 3.0;
  }
}

Vec3 Path::wish(const Vec3& tip) {
  const bool is_turn = cycle_ % period_ == 0;
  const bool is_even = (cycle_ / period_) % 2 == 0;
  switch (route_) {
    case Route::push:
      if (is_turn) heading_ = inwards_;
      return longest_ * heading_;
    case Route::slide:
      if (is_turn) heading_ = random_->direction();
      return longest_ * (inwards_ + random_->uniform(0.0, 2.0) * heading_);
    case Route::walk:
      return kept_ * std::pow(10.0, random_->uniform(-3.0, 1.0)) * random_->direction();
    case Route::aim:
      if (cycle_ % attention_ == 0) goal_ = target_on_triangle();
      // Beyond it, or short of it.
      return random_->uniform(0.5, 2.0) * (goal_ - tip);
    case Route::ping_pong:
      if (cycle_ == 0) heading_ = inwards_;
      return (is_even ? longest_ : -longest_) * heading_;
    case Route::tremor:
      if (is_turn) goal_ = tip + (guess_ + kept_ + longest_) * inwards_;
      return goal_ - tip + longest_ * random_->uniform(0.0, 2.0) * random_->direction();
    case Route::come_back:
      if (is_turn) heading_ = (inwards_ + 0.3 * random_->direction()).normalized();
      return (is_even ? longest_ : -longest_) * heading_;
    case Route::through: {
      if (is_turn || (goal_ - tip).norm() < longest_) {
        const Mesh& mesh = *scene_->mesh();
        goal_ = mesh.vertex(static_cast<VertexId>(random_->below(mesh.vertex_count())));
        if (random_->uniform() < 0.5) goal_ = tip + 100.0 * scene_->mean_edge() * inwards_;
      }
      return goal_ - tip;
    }
  }
  return Vec3::Zero();
}

Vec3 Path::next(const Vec3& tip) {
  if (cycle_ % attention_ == 0 || cycle_ % period_ == 0) look(tip);
  Vec3 step = clipped(wish(tip), longest_);
  if (has_all_lengths_) step *= std::pow(10.0, random_->uniform(-3.0, 0.0));
  ++cycle_;
  return step;
}

Joints::Joints(const Setup& setup, Random& random)
    : random_(&random),
      has_limits_(setup.has_limits),
      longest_(setup.longest_step),
      jacobian_(3, setup.joints) {}

void Joints::draw() {
  const double scale = std::pow(10.0, random_->uniform(-1.0, 2.0));
  const double spread =
      random_->uniform() < 0.3 ? std::pow(10.0, random_->uniform(-8.0, 0.0)) : 1.0;
  const Eigen::Index n = jacobian_.cols();
  const Vec3 common = random_->direction();
  for (Eigen::Index c = 0; c < n; ++c) {
    // All joints may do nearly the same: far from the tip, or near a singular pose.
    const Vec3 own = random_->direction();
    jacobian_.col(c) = scale * (spread < 1.0 ? Vec3(common + spread * own) : own);
  }
  rows_.fill(0.0);
  for (Eigen::Index c = 0; c < n; ++c) {
    const double limit = longest_ / scale * std::pow(10.0, random_->uniform(-1.0, 1.0));
    for (int side = 0; side < 2; ++side) {
      const auto row = static_cast<std::size_t>(2 * c + side);
      rows_[row * static_cast<std::size_t>(n) + static_cast<std::size_t>(c)] =
          side == 0 ? 1.0 : -1.0;
      bounds_[row] = -limit;
    }
  }
}

void Joints::attach(Motion& motion) {
  if (jacobian_.cols() == 0) return;
  if (cycle_++ % 40 == 0) draw();
  motion.jacobian = TipJacobian(jacobian_);
  if (has_limits_) motion.rows = ExtraRows(rows_.data(), bounds_.data(), 2 * jacobian_.cols());
}

}  // namespace keepout::app
