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
    : scene_(&scene), random_(&random), speed_(speed), period_(250), attention_(10) {}

Twist Attacker::next(const Vec3& at) {
  const bool is_turn = cycle_ % period_ == 0;
  if (is_turn || cycle_ % attention_ == 0) look(at);
  if (is_turn && speed_ > 0.0) {
    route_ = static_cast<Route>(static_cast<std::size_t>(Route::press) + random_->below(5));
    const double share = random_->uniform() < 0.5 ? 1.0 : random_->uniform(0.1, 1.0);
    longest_ = share * speed_ * fastest_way;
    turn_ = share * speed_ * fastest_turn;
    heading_ = random_->direction();
    axis_ = random_->direction();
    goal_ = at + (guess_ + random_->uniform(5.0, 40.0)) * inwards_;
  }
  Twist twist = wish(at, is_turn);
  if (speed_ == 0.0) twist.linear = clipped(twist.linear, longest_);
  if (has_all_lengths_) twist.linear *= std::pow(10.0, random_->uniform(-3.0, 0.0));
  ++cycle_;
  return twist;
}

void Attacker::look(const Vec3& at) {
  const auto [triangle, closest] = scene_->nearest(at, guess_);
  guess_ = 1.1 * closest.distance;
  triangle_ = triangle;
  inwards_ =
      closest.distance > 0.0 ? Vec3(closest.offset / closest.distance) : random_->direction();
}

/// Returns a corner, the middle of an edge or the center of the nearest triangle.
Vec3 Attacker::target_on_triangle() const {
  const Triangle c = scene_->mesh()->triangle(triangle_);
  const std::size_t corner = random_->below(3), kind = random_->below(5);
  if (kind < 2) return c[corner];
  if (kind < 4) return 0.5 * (c[corner] + c[(corner + 1) % 3]);
  return (c[0] + c[1] + c[2]) / 3.0;
}

Twist Attacker::wish(const Vec3& at, bool is_turn) {
  const double there_and_back = (cycle_ / period_) % 2 == 0 ? longest_ : -longest_;
  switch (route_) {
    case Route::push:
      if (is_turn) heading_ = inwards_;
      return {.linear = longest_ * heading_};
    case Route::slide:
      if (is_turn) heading_ = random_->direction();
      return {.linear = longest_ * (inwards_ + random_->uniform(0.0, 2.0) * heading_)};
    case Route::walk:
      return {.linear = kept_ * std::pow(10.0, random_->uniform(-3.0, 1.0)) * random_->direction()};
    case Route::aim:
      if (cycle_ % attention_ == 0) goal_ = target_on_triangle();
      // The motion may overshoot the goal or fall short of it.
      return {.linear = random_->uniform(0.5, 2.0) * (goal_ - at)};
    case Route::ping_pong:
      if (cycle_ == 0) heading_ = inwards_;
      return {.linear = there_and_back * heading_};
    case Route::tremor:
      if (is_turn) goal_ = at + (guess_ + kept_ + longest_) * inwards_;
      return {.linear = goal_ - at + longest_ * random_->uniform(0.0, 2.0) * random_->direction()};
    case Route::come_back:
      if (is_turn) heading_ = (inwards_ + 0.3 * random_->direction()).normalized();
      return {.linear = there_and_back * heading_};
    case Route::through:
      if (is_turn || (goal_ - at).norm() < longest_) {
        const Mesh& mesh = *scene_->mesh();
        goal_ = mesh.vertex(static_cast<VertexId>(random_->below(mesh.vertex_count())));
        if (random_->uniform() < 0.5) goal_ = at + 100.0 * scene_->mean_edge() * inwards_;
      }
      return {.linear = goal_ - at};
    case Route::press:
      return {.linear = longest_ * inwards_};
    case Route::drag:
      return {.linear = clipped(longest_ * (0.6 * inwards_ + heading_), longest_)};
    case Route::turn:
      return {.linear = 0.3 * longest_ * inwards_, .angular = turn_ * axis_};
    case Route::tremble:
      return {.linear = 0.5 * (clipped(goal_ - at, longest_) + longest_ * random_->direction()),
              .angular = random_->uniform() * turn_ * random_->direction()};
    case Route::go_behind:
      break;
  }
  return {.linear = clipped(goal_ - at, longest_), .angular = 0.25 * turn_ * axis_};
}

}  // namespace keepout::app
