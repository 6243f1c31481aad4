// SPDX-License-Identifier: BSD-3-Clause
#include "push.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

namespace keepout::peers {
namespace {

/// Without a margin a tip may lie on the surface; closer than this, it counts as on it. [mm]
constexpr double touch = 1e-6;

/// A step that a rule limited, for a comparison with the best safe step.
struct LimitedStep {
  Vec3 tip;
  Vec3 desired;
  double lost;
  double clearance;
};

/// Decides for each step if the tip enters, and how deep it is.
class EntryJudge {
 public:
  EntryJudge(Judge& judge, const Vec3& start, double margin)
      : judge_(judge), oracle_(judge.oracle()), may_touch_(margin == 0.0) {
    if (judge.closed()) starts_inside_ = is_inside_ = *oracle_.inside(start);
  }

  void step(const Vec3& from, const Vec3& to, bool crosses) {
    if (crosses && judge_.closed()) is_inside_ = *oracle_.inside(to);
    const bool is_wrong = is_inside_ != starts_inside_;
    if (is_wrong) {
      const double depth = oracle_.distance(to);
      depth_ = std::max(depth_, depth);
      if (depth > touch) entered_ = true;
    }
    if (!crosses || entered_) return;
    entered_ = !may_touch_ || (oracle_.distance(from) > touch && oracle_.distance(to) > touch);
  }

  bool entered() const noexcept { return entered_; }
  double depth() const noexcept { return depth_; }

 private:
  Judge& judge_;
  oracle::SafetyOracle& oracle_;
  bool may_touch_;
  bool starts_inside_ = false, is_inside_ = false, entered_ = false;
  double depth_ = 0.0;
};

}  // namespace

PointPusher::PointPusher(const Terrain& terrain, Route route, double longest, const Random& random)
    : terrain_(&terrain),
      route_(route),
      longest_(longest),
      random_(random),
      near_(terrain.index()->shared_mesh(), terrain.index(), terrain.mesh().triangle_count(),
            budget_),
      period_(std::max(1, static_cast<int>(random_.uniform(1.0, 10.0) / longest))),
      attention_(period_) {
  if (route == Route::slide || route == Route::wedge) {
    attention_ = std::max(1, static_cast<int>(0.5 / longest));
  }
}

Vec3 PointPusher::next(const Vec3& tip) {
  if (cycle_ % attention_ == 0) look(tip);
  const Vec3 wished = wish(tip, cycle_ % period_ == 0);
  ++cycle_;
  const double length = wished.norm();
  return length > longest_ ? Vec3(wished * (longest_ / length)) : wished;
}

void PointPusher::look(const Vec3& tip) {
  budget_.renew();
  const Hit nearest = find_nearest(near_, tip).value();
  const double distance = nearest.closest.distance;
  inwards_ = distance > 0.0 ? Vec3(nearest.closest.offset / distance) : random_.direction();
  if (route_ == Route::wedge) {
    const Triangle t = terrain_->mesh().triangle(nearest.triangle);
    const std::array<Vec3, 3> goals{t[0], 0.5 * (t[1] + t[2]), (t[0] + t[1] + t[2]) / 3.0};
    goal_ = goals[random_.below(3)];
  } else if (route_ == Route::press) {
    goal_ = tip + (distance + 2.0 * longest_) * inwards_;
  } else if (route_ == Route::through) {
    const auto vertex = static_cast<VertexId>(random_.below(terrain_->mesh().vertex_count()));
    goal_ = terrain_->mesh().vertex(vertex);
  } else if (kind_of(route_) != Terrain::Kind::plain) {
    goal_ = terrain_->mesh().vertex(choose_vertex(tip, distance));
    goal_ += longest_ * random_.uniform() * random_.direction();
  }
}

/// Returns a random rim or saddle near the tip; without one, a corner of the nearest triangle.
VertexId PointPusher::choose_vertex(const Vec3& tip, double distance) {
  const Terrain::Kind kind = kind_of(route_);
  VertexId chosen = 0;
  std::size_t seen = 0;
  double nearest = std::numeric_limits<double>::infinity();
  if (!near_.gather({tip, distance + 1.0 + longest_})) return chosen;
  for (const Hit& hit : near_.hits()) {
    for (const VertexId v : terrain_->mesh().corners(hit.triangle)) {
      if (terrain_->kind(v) == kind && random_.below(++seen) == 0) chosen = v;
      if (seen == 0 && hit.closest.distance < nearest) chosen = v;
    }
    nearest = std::min(nearest, hit.closest.distance);
  }
  return chosen;
}

Vec3 PointPusher::wish(const Vec3& tip, bool decides) {
  if (route_ == Route::push) return longest_ * inwards_;
  if (route_ == Route::slide) {
    if (decides) heading_ = random_.uniform(0.3, 2.0) * random_.direction();
    return longest_ * (inwards_ + heading_);
  }
  const Vec3 wished = goal_ - tip;
  if (route_ == Route::wedge) return random_.uniform(0.5, 2.0) * wished;
  if (route_ == Route::press) {
    const double tremor = longest_ * random_.uniform(0.0, 2.0);
    return wished + tremor * random_.direction();
  }
  return wished;
}

Push push(Judge& judge, Rule* rule, Pusher& pusher, const Vec3& start,
          const PushSettings& settings) {
  using Clock = std::chrono::steady_clock;
  const double margin = settings.margin, reach = 2.0 * margin;
  oracle::SafetyOracle& oracle = judge.oracle();
  EntryJudge entry(judge, start, margin);
  Random random(settings.random);
  std::vector<LimitedStep> limited;
  std::size_t limited_steps = 0;
  Push found;
  found.clearance = reach;
  Vec3 tip = start;
  for (int cycle = 0, inside = 0; cycle < settings.cycles && inside <= settings.cycles_inside;
       ++cycle) {
    const Vec3 desired = pusher.next(tip);
    const Clock::time_point begun = Clock::now();
    const Vec3 motion = rule ? rule->step(tip, desired) : desired;
    found.seconds += std::chrono::duration<double>(Clock::now() - begun).count();
    const Vec3 end = tip + motion;
    // A tip that is closer than the margin may stay so.
    const double at_start = oracle.check(tip, tip, 0.0, margin).distance;
    const double kept = std::min(margin, at_start);
    const oracle::Finding executed = oracle.check(tip, end, kept * (1.0 - 1e-6), reach);
    found.clearance = std::min(found.clearance, executed.distance);
    const bool was_outside = !entry.entered();
    entry.step(tip, end, executed.crosses);
    ++found.steps;
    if (entry.entered()) {
      ++inside;
    } else if (was_outside) {
      const double lost = (motion - desired).norm(), length = desired.norm();
      const oracle::Finding asked = oracle.check(tip, tip + desired, margin);
      const bool is_free = !asked.below && !asked.crosses && length > 0.0;
      const bool is_safe = !executed.below && !executed.crosses;
      if (is_free) {
        found.free_asked += length;
        found.free_lost += std::min(lost, length);
      } else if (is_safe && length > 0.0 && at_start > 0.0) {
        // Reservoir sampling: each limited step is chosen with the same probability.
        ++limited_steps;
        const LimitedStep step{tip, desired, lost, kept};
        if (limited.size() < static_cast<std::size_t>(settings.best_steps)) {
          limited.push_back(step);
        } else if (const auto i = random.below(limited_steps); i < limited.size()) {
          limited[i] = step;
        }
      }
      found.unsafe += !is_safe;
    }
    tip = end;
  }
  found.entered = entry.entered();
  found.depth = entry.depth();
  for (const LimitedStep& step : limited) {
    const double cost = std::get<1>(judge.best_step(step.tip, step.desired, step.clearance));
    found.excess += (step.lost - cost) / step.desired.norm();
  }
  found.excess_of = static_cast<int>(limited.size());
  return found;
}

}  // namespace keepout::peers
