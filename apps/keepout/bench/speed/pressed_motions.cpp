// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/pressed_motions.h"

#include "bench/speed/stepper.h"
#include "keepout/error.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/nearest.h"
#include "number_text.h"

namespace keepout::app {
namespace {

constexpr std::size_t cycles_of_a_stroke = 50;
constexpr int most_rounds = 50;  // three are enough where most strokes find room

/// The hand: half of what it asks for leads to the surface, half along it.
class Hand {
 public:
  Hand(const IndexedMesh& on, const MotionKind& kind, Random& random)
      : nearest_(*on.mesh, *on.index), kind_(kind), random_(random) {}

  /// From above a place to the clearance. Whether there is room.
  bool set_down(Vec3& tip) {
    const ClosestPoint closest = nearest_(tip, 2.0 * kind_.clearance).closest;
    if (closest.distance < kind_.clearance) return false;
    constexpr double not_quite = 0.999;  // or rounding would make it too close
    tip += not_quite * (1.0 - kind_.clearance / closest.distance) * closest.offset;
    heading_ = random_.direction();
    return true;
  }

  Vec3 next(const Vec3& tip) {
    const ClosestPoint closest = nearest_(tip, 1.01 * kind_.clearance).closest;
    const Vec3 down = closest.offset / closest.distance;
    Vec3 along = heading_ - heading_.dot(down) * down;
    if (along.norm() > 0.0) along.normalize();
    const Vec3 way = down + along + 0.3 * random_.direction();
    return random_.uniform(kind_.shortest, kind_.longest) * way.normalized();
  }

 private:
  NearestTriangle nearest_;
  const MotionKind& kind_;
  Random& random_;
  Vec3 heading_ = Vec3::UnitX();
};

}  // namespace

std::vector<Motion> pressed_motions(const IndexedMesh& on, std::size_t count,
                                    const MotionKind& kind, Random& random) {
  Stepper rule = certified(on, kind.clearance, Form::searching);
  Hand hand(on, kind, random);
  std::vector<Motion> motions;
  motions.reserve(count);
  const std::size_t strokes = count / cycles_of_a_stroke + 1;
  for (int round = 0; round < most_rounds && motions.size() < count; ++round) {
    for (Vec3 tip : surface_points(*on.mesh, strokes, 1.5 * kind.clearance, random)) {
      if (!hand.set_down(tip)) continue;
      for (std::size_t cycle = 0; cycle < cycles_of_a_stroke && motions.size() < count; ++cycle) {
        const Motion motion{.tip = tip, .desired = hand.next(tip)};
        const Answer answer = rule.ask(motion);
        if (!is_ok(answer.status)) break;
        if (answer.status == Status::limited) motions.push_back(motion);
        tip += answer.motion;
      }
    }
  }
  if (motions.size() < count) {
    throw Error("hardly anywhere has the mesh room for a tip that is " +
                length_text(kind.clearance) + " off it");
  }
  return motions;
}

}  // namespace keepout::app
