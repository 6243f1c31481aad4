// SPDX-License-Identifier: BSD-3-Clause
#include "judge.h"

#include <algorithm>
#include <array>

namespace keepout::app {

std::string_view name(Breach breach) noexcept {
  constexpr std::array<std::string_view, breach_kinds> names{
      "penetration", "too_near", "too_long", "moved_anyway", "led_deeper", "left_inside"};
  return names[static_cast<std::size_t>(breach)];
}

double tolerance(const Scene& scene, const StepOptions& options, const Vec3& tip) noexcept {
  const double lengths =
      scene.longest_edge() + options.radius * (1.0 + 1e-9) + required_clearance(options);
  return 2e-10 * lengths + 4e-16 * tip.lpNorm<1>();
}

Judge::Judge(const Scene& scene, const Setup& setup)
    : scene_(&scene),
      oracle_(scene.oracle()),
      options_(setup.options),
      has_sides_(setup.inside == Inside::led_out && scene.has_sides() && setup.joints == 0) {
  take_in(setup.tip);
}

void Judge::take_in(const Vec3& tip) {
  const double tau = tolerance(*scene_, options_, tip);
  distance_ = oracle_.distance(tip);
  is_touching_ = distance_ <= 4.0 * tau;
  is_forbidden_ = has_sides_ && scene_->is_forbidden(tip);
  has_kept_ = !is_forbidden_ && distance_ >= required_clearance(options_) - 2.75 * tau;
}

bool Judge::is_too_long(const Motion& motion, const Step& step) const noexcept {
  const double length = step.motion.norm();
  if (!(length <= options_.radius * (1.0 + 2e-9))) return true;
  const bool is_projection = !motion.jacobian && step.status != Status::recovering;
  // A tip that lost some tau of its distance is led back by as much on top.
  const double tau = tolerance(*scene_, options_, motion.tip);
  return is_projection && length > motion.desired.norm() * (1.0 + 1e-9) + 3.0 * tau;
}

Verdict Judge::judge_way_out(const Motion& motion, const Vec3& to, Verdict verdict) {
  const double depth = oracle_.distance(motion.tip);
  take_in(to);
  verdict.was_led_out = true;
  verdict.threshold = depth;
  verdict.distance = distance_;
  if (is_forbidden_ && distance_ > depth + 3.0 * verdict.tolerance) {
    verdict.breach = Breach::led_deeper;
  }
  return verdict;
}

Verdict Judge::judge(const Motion& motion, const Step& step) {
  Verdict verdict;
  if (!step.motion.allFinite() || (!step.ok() && !step.motion.isZero(0.0))) {
    verdict.breach = Breach::moved_anyway;
    return verdict;
  }
  const Vec3 to = motion.tip + step.motion;
  if (to == motion.tip) return verdict;

  const double tau = tolerance(*scene_, options_, motion.tip);
  const double kept = required_clearance(options_);
  verdict.tolerance = tau;
  if (is_too_long(motion, step)) {
    verdict.breach = Breach::too_long;
    return verdict;
  }
  if (has_sides_ && (is_forbidden_ || is_touching_)) {
    if (step.status == Status::recovering) return judge_way_out(motion, to, verdict);
    if (is_forbidden_) {
      verdict.breach = Breach::left_inside;
      return verdict;
    }
  }

  const double due = has_kept_ ? kept : std::min(kept, distance_);
  verdict.threshold = std::max(0.0, due - 3.0 * tau);
  const oracle::Finding finding =
      oracle_.check(motion.tip, to, verdict.threshold, kept + 4.0 * tau);
  if (has_kept_) verdict.distance = finding.distance;
  verdict.triangle = finding.triangle;
  if (finding.crosses || finding.below) {
    verdict.distance = finding.distance;
    verdict.breach = finding.crosses ? Breach::penetration : Breach::too_near;
    return verdict;
  }
  if (!has_kept_) take_in(to);
  return verdict;
}

}  // namespace keepout::app
