// SPDX-License-Identifier: BSD-3-Clause
#include "slide.h"

#include <algorithm>
#include <utility>

#include "nearest_motion.h"

namespace keepout::peers {
namespace {

class Slide : public Rule {
 public:
  Slide(const Task& task, std::shared_ptr<const Sweep> sweep)
      : corridor_(task.corridor), sweep_(std::move(sweep)) {}

  Vec3 step(const Vec3& tip, const Vec3& desired) override {
    constexpr int sweeps = 4;
    constexpr double rise = 1e-3;  // away from the surface, so that rounding is no new contact
    Vec3 place = tip, rest = desired;
    for (int i = 0; i < sweeps; ++i) {
      planes_.begin(corridor_, place);
      rest = planes_.to(rest);
      if (!(rest.dot(desired) > 0.0)) break;
      const auto [fraction, normal] = (*sweep_)(place, rest);
      Vec3 end = place + fraction * rest;
      if (i > 0) {  // the tip moves straight to the end, not around the turn
        end = tip + (*sweep_)(tip, end - tip).fraction * (end - tip);
        if ((end - tip - desired).norm() >= (place - tip - desired).norm()) break;
      }
      place = end;
      if (fraction == 1.0) break;
      rest *= 1.0 - fraction;
      rest -= std::min(0.0, normal.dot(rest)) * normal;
      rest += rise * rest.norm() * normal;
    }
    return place - tip;
  }

 private:
  std::optional<Corridor> corridor_;
  std::shared_ptr<const Sweep> sweep_;
  NearestMotion planes_;
};

}  // namespace

std::unique_ptr<Rule> slide(const Task& task, std::shared_ptr<const Sweep> sweep) {
  return std::make_unique<Slide>(task, std::move(sweep));
}

}  // namespace keepout::peers
