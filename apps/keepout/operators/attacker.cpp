// SPDX-License-Identifier: BSD-3-Clause
#include "operators/attacker.h"

#include <cmath>

#include "shared/clip.h"

namespace keepout::app {

Attacker::Attacker(Scene& scene, Random& random, Route route, double longest, double kept)
    : scene_(&scene),
      random_(&random),
      route_(route),
      longest_(longest),
      kept_(kept),
      period_(10 + random.below(110)),
      has_all_lengths_(random.uniform() < 0.4) {
  const bool is_watchful = route == Route::aim || route == Route::slide;
  attention_ = is_watchful ? 4 + random.below(12) : 64;
}

Attacker::Attacker(Scene& scene, Random& random, double speed)
    : scene_(&scene),
      random_(&random),
      route_(Route::press),
      speed_(speed),
      period_(250),
      attention_(10) {}

Twist Attacker::next(const Vec3& at) {
  const bool is_turn = cycle_ % period_ == 0;
  if (is_turn || cycle_ % attention_ == 0) look(at);
  const bool is_flange = route_ >= Route::press;
  if (is_turn && is_flange) draw_route(at);
  const Twist twist = is_flange ? flange_motion(at) : Twist{.linear = tip_motion(at)};
  ++cycle_;
  return twist;
}

void Attacker::look(const Vec3& at) {
  const Hit hit = scene_->nearest(at, guess_);
  guess_ = 1.1 * hit.closest.distance;
  triangle_ = hit.triangle;
  inwards_ = hit.closest.distance > 0.0 ? Vec3(hit.closest.offset / hit.closest.distance)
                                        : random_->direction();
}

void Attacker::draw_route(const Vec3& at) {
  route_ = static_cast<Route>(static_cast<std::size_t>(Route::press) + random_->below(5));
  const double share = random_->uniform() < 0.5 ? 1.0 : random_->uniform(0.1, 1.0);
  way_ = share * speed_ * fastest_way;
  turn_ = share * speed_ * fastest_turn;
  heading_ = random_->direction();
  axis_ = random_->direction();
  goal_ = at + (guess_ + random_->uniform(5.0, 40.0)) * inwards_;
}

/// Returns a corner of the nearest triangle, the middle of an edge, or the center.
Vec3 Attacker::target_on_triangle() const {
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

Vec3 Attacker::tip_motion(const Vec3& tip) {
  const bool is_turn = cycle_ % period_ == 0;
  const double sign = (cycle_ / period_) % 2 == 0 ? 1.0 : -1.0;
  Vec3 wish = Vec3::Zero();
  switch (route_) {
    case Route::slide:
      if (is_turn) heading_ = random_->direction();
      wish = longest_ * (inwards_ + random_->uniform(0.0, 2.0) * heading_);
      break;
    case Route::walk:
      wish = kept_ * std::pow(10.0, random_->uniform(-3.0, 1.0)) * random_->direction();
      break;
    case Route::aim:
      if (cycle_ % attention_ == 0) goal_ = target_on_triangle();
      // Beyond it, or short of it.
      wish = random_->uniform(0.5, 2.0) * (goal_ - tip);
      break;
    case Route::ping_pong:
      if (cycle_ == 0) heading_ = inwards_;
      wish = sign * longest_ * heading_;
      break;
    case Route::tremor:
      if (is_turn) goal_ = tip + (guess_ + kept_ + longest_) * inwards_;
      wish = goal_ - tip + longest_ * random_->uniform(0.0, 2.0) * random_->direction();
      break;
    case Route::come_back:
      if (is_turn) heading_ = (inwards_ + 0.3 * random_->direction()).normalized();
      wish = sign * longest_ * heading_;
      break;
    case Route::through:
      if (is_turn || (goal_ - tip).norm() < longest_) {
        const Mesh& mesh = *scene_->mesh();
        goal_ = mesh.vertex(static_cast<VertexId>(random_->below(mesh.vertex_count())));
        if (random_->uniform() < 0.5) goal_ = tip + 100.0 * scene_->mean_edge() * inwards_;
      }
      wish = goal_ - tip;
      break;
    default:  // push
      if (is_turn) heading_ = inwards_;
      wish = longest_ * heading_;
  }
  const double share = has_all_lengths_ ? std::pow(10.0, random_->uniform(-3.0, 0.0)) : 1.0;
  return share * clipped(wish, longest_);
}

Twist Attacker::flange_motion(const Vec3& flange) {
  switch (route_) {
    case Route::press:
      return {.linear = way_ * inwards_};
    case Route::drag:
      return {.linear = clipped(way_ * (0.6 * inwards_ + heading_), way_)};
    case Route::turn:
      return {.linear = 0.3 * way_ * inwards_, .angular = turn_ * axis_};
    case Route::tremble:
      return {.linear = 0.5 * (clipped(goal_ - flange, way_) + way_ * random_->direction()),
              .angular = random_->uniform() * turn_ * random_->direction()};
    default:  // go_behind
      return {.linear = clipped(goal_ - flange, way_), .angular = 0.25 * turn_ * axis_};
  }
}

}  // namespace keepout::app
