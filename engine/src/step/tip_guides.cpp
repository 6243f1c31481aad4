// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/tip_guides.h"

#include <algorithm>
#include <utility>

#include "keepout/error.h"

namespace keepout {
namespace {

constexpr std::size_t planes_of_a_guide = TipGuides::most_rows / TipGuides::most;
constexpr int most_rounds = 8;

Eigen::Index caller_rows(const Motion& motion) noexcept {
  return motion.rows ? motion.rows->count() : 0;
}

Eigen::Index variables(const Motion& motion) noexcept {
  return motion.jacobian ? motion.jacobian->joints() : 3;
}

}  // namespace

TipGuides::TipGuides(std::vector<TipGuide> guides, std::size_t joints, std::size_t extra_rows)
    : guides_(std::move(guides)),
      states_(guides_.size()),
      allowed_(guides_.size()),
      planes_(planes_of_a_guide * guides_.size()) {
  if (guides_.size() > most) {
    throw Error("a tip has at most " + std::to_string(most) + " guides, not " +
                std::to_string(guides_.size()));
  }
  for (const TipGuide& guide : guides_) {
    if (guide.band >= shortest_length && guide.band <= longest_length) continue;
    throw Error("the band of guide '" + guide.name + "' must be above zero, and a length");
  }
  const std::size_t columns = std::max<std::size_t>(joints, 3);
  held_.reserve(planes_.capacity());
  increment_.resize(columns);
  matrix_.resize((extra_rows + planes_.capacity()) * columns);
  bounds_.resize(extra_rows + planes_.capacity());
}

Step TipGuides::step(MotionConstraint& guard, const Motion& motion, SideWatch* sides,
                     StageTimes* times) noexcept {
  if (times != nullptr) *times = {};
  const auto columns = static_cast<std::size_t>(variables(motion));
  const auto rows = static_cast<std::size_t>(caller_rows(motion));
  if (columns > increment_.size() || rows + planes_.capacity() > bounds_.size()) {
    return {.status = Status::over_capacity};
  }
  recovery_ = guard.options().recovery;
  open(motion);
  Step result;
  for (int round = 0; round < most_rounds; ++round) {
    result = solve(guard, motion, sides, times);
    if (!result.ok()) {
      if (!soften()) return result;
      continue;
    }
    if (add_violated(motion, result)) continue;
    break;
  }
  if (result.ok()) cut(motion, result);
  if (result.ok()) tell(motion, result);
  return result;
}

/// Begins with the planes of what is out, and of what held the last motion back.
void TipGuides::open(const Motion& motion) noexcept {
  softening_ = Softening::none;
  planes_.clear();
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    const double excess = guides_[g].region.excess(motion.tip);
    states_[g] = {.excess = excess};
    allowed_[g] = std::max(guides_[g].band, excess);
    const bool has_held = std::find(held_.begin(), held_.end(), g) != held_.end();
    if (has_held || excess > 0.0) add(g, motion.tip, motion.tip);
  }
  held_.clear();
}

/// The plane that touches a guide's region where the tip would be `at`.
void TipGuides::add(std::size_t g, const Vec3& tip, const Vec3& at) noexcept {
  const Region& region = guides_[g].region;
  const Vec3 into = -region.outward(at);
  if (into.isZero(0.0)) return;
  const double bound = into.dot(region.origin() - tip) - region.radius();
  planes_.push({g, into, std::min(bound, softening_ == Softening::none ? recovery_ : 0.0)});
}

/// The guard's step under the caller's rows and the planes there are.
Step TipGuides::solve(MotionConstraint& guard, const Motion& motion, SideWatch* sides,
                      StageTimes* times) noexcept {
  const Eigen::Index columns = variables(motion);
  const Eigen::Index rows = caller_rows(motion);
  double* row =
      std::copy_n(rows > 0 ? motion.rows->matrix() : nullptr, rows * columns, matrix_.data());
  double* bound = std::copy_n(rows > 0 ? motion.rows->bounds() : nullptr, rows, bounds_.data());
  for (const Plane& plane : planes_) {
    for (Eigen::Index c = 0; c < columns; ++c) {
      *row++ =
          motion.jacobian ? plane.normal.dot(motion.jacobian->matrix().col(c)) : plane.normal[c];
    }
    *bound++ = plane.bound;
  }
  Motion guided = motion;
  const Eigen::Index count = bound - bounds_.data();
  if (count > 0) guided.rows = ExtraRows(matrix_.data(), bounds_.data(), count);
  if (sides != nullptr) return guard.step(guided, *sides);
  if (times == nullptr) return guard.step(guided);
  StageTimes of_trial;
  const Step step = guard.step(guided, of_trial);
  times->query += of_trial.query;
  times->activation += of_trial.activation;
  times->solve += of_trial.solve;
  return step;
}

/// Adds planes where a step would leave regions. Whether there are new ones.
bool TipGuides::add_violated(const Motion& motion, const Step& step) noexcept {
  const std::size_t before = planes_.size();
  const Vec3 end = motion.tip + step.motion;
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    if (guides_[g].region.excess(end) > allowed_[g]) add(g, motion.tip, end);
  }
  return planes_.size() > before;
}

/// Lets go of leading back. Whether there was any to let go of.
bool TipGuides::soften() noexcept {
  bool changed = false;
  for (Plane& plane : planes_) {
    if (!(plane.bound > 0.0)) continue;
    plane.bound = 0.0;
    states_[plane.guide].gave_way = changed = true;
  }
  if (changed) softening_ = Softening::guides;
  return changed;
}

/// Where no planes were found that hold it, a part of the motion: it is as safe as all of it.
void TipGuides::cut(const Motion& motion, Step& step) noexcept {
  const auto is_kept = [&](double share) {
    for (std::size_t g = 0; g < guides_.size(); ++g) {
      if (!(guides_[g].region.excess(motion.tip + share * step.motion) <= allowed_[g]))
        return false;
    }
    return true;
  };
  if (is_kept(1.0)) return;
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    if (guides_[g].region.excess(motion.tip + step.motion) > allowed_[g]) states_[g].holds = true;
  }
  double share = 0.0;
  for (double part = 0.5; part > 1e-3; part *= 0.5) {
    if (is_kept(share + part)) share += part;
  }
  const bool asks_for_motion =
      motion.rows &&
      std::any_of(motion.rows->bounds(), motion.rows->bounds() + motion.rows->count(),
                  [](double bound) { return bound > 0.0; });
  if (asks_for_motion) {
    step = {.status = Status::unsolved};
    return;
  }
  for (std::size_t i = 0; i < step.increment.size(); ++i) {
    increment_[i] = share * step.increment[i];
  }
  step.status = Status::fallback;
  step.motion *= share;
  step.increment = {increment_.data(), step.increment.size()};
}

/// What held the motion back.
void TipGuides::tell(const Motion& motion, Step& step) noexcept {
  const std::size_t first = step.planes.size() + static_cast<std::size_t>(caller_rows(motion));
  for (const std::uint32_t row : step.active) {
    if (row < first || row - first >= planes_.size()) continue;
    const std::size_t g = planes_[row - first].guide;
    states_[g].holds = true;
    if (std::find(held_.begin(), held_.end(), g) == held_.end()) held_.push_back(g);
  }
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    if (states_[g].excess > guides_[g].band) step.status = Status::recovering;
  }
}

}  // namespace keepout
