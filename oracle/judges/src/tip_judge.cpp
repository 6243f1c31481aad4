// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/judges/tip_judge.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <utility>

namespace keepout::oracle {

std::string_view name(Breach breach) noexcept {
  constexpr std::array<std::string_view, breach_kinds> names{
      "penetration", "too_near",      "too_long",   "moved_anyway", "led_deeper",
      "left_inside", "limits_broken", "guide_left", "strayed"};
  return names[static_cast<std::size_t>(breach)];
}

JudgedSurface::JudgedSurface(std::shared_ptr<const Mesh> mesh) : oracle_(std::move(mesh)) {
  const Mesh& surface = oracle_.tree()->mesh();
  const Vec3 center = surface.bounds().center();
  double volume = 0.0;
  for (TriangleId t = 0; t < surface.triangle_count(); ++t) {
    const Triangle c = surface.triangle(t);
    for (int e = 0; e < 3; ++e) {
      longest_edge_ = std::max(longest_edge_, (c[(e + 1) % 3] - c[e]).norm());
    }
    volume += (c[0] - center).dot((c[1] - center).cross(c[2] - center));
  }
  free_inside_ = volume < 0.0;
}

bool JudgedSurface::is_forbidden(const Vec3& point) const {
  return oracle_.inside(point).value() != free_inside_;
}

double JudgedSurface::tolerance(const StepOptions& options, const Vec3& tip) const noexcept {
  const double lengths =
      longest_edge_ + options.radius * (1.0 + 1e-9) + required_clearance(options);
  return 2e-10 * lengths + 4e-16 * tip.lpNorm<1>();
}

TipJudge::TipJudge(const JudgedSurface& surface, const StepOptions& options, bool leads_out,
                   const Vec3& tip)
    : surface_(&surface), oracle_(surface.oracle()), options_(options), leads_out_(leads_out) {
  take_in(tip);
}

void TipJudge::take_in(const Vec3& tip) {
  const double tau = surface_->tolerance(options_, tip);
  distance_ = oracle_.distance(tip);
  is_touching_ = distance_ <= 4.0 * tau;
  is_forbidden_ = leads_out_ && surface_->is_forbidden(tip);
  has_kept_ = !is_forbidden_ && distance_ >= required_clearance(options_) - 2.75 * tau;
}

bool TipJudge::is_too_long(const Motion& motion, const Step& step) const noexcept {
  const double length = step.motion.norm();
  if (!(length <= options_.radius * (1.0 + 2e-9))) return true;
  const bool is_projection = !motion.jacobian && step.status != Status::recovering;
  // A tip that lost some tau of its distance may also recover by as much.
  const double tau = surface_->tolerance(options_, motion.tip);
  return is_projection && length > motion.desired.norm() * (1.0 + 1e-9) + 3.0 * tau;
}

TipVerdict TipJudge::judge_way_out(const Motion& motion, const Vec3& to, TipVerdict verdict) {
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

TipVerdict TipJudge::judge(const Motion& motion, const Step& step) {
  TipVerdict verdict;
  if (!step.motion.allFinite() || (!step.ok() && !step.motion.isZero(0.0))) {
    verdict.breach = Breach::moved_anyway;
    return verdict;
  }
  const Vec3 to = motion.tip + step.motion;
  if (to == motion.tip) return verdict;

  const double tau = surface_->tolerance(options_, motion.tip);
  const double kept = required_clearance(options_);
  verdict.tolerance = tau;
  if (is_too_long(motion, step)) {
    verdict.breach = Breach::too_long;
    return verdict;
  }
  if (leads_out_ && (is_forbidden_ || is_touching_)) {
    if (step.status == Status::recovering) return judge_way_out(motion, to, verdict);
    if (is_forbidden_) {
      verdict.breach = Breach::left_inside;
      return verdict;
    }
  }

  const double due = has_kept_ ? kept : std::min(kept, distance_);
  verdict.threshold = std::max(0.0, due - 3.0 * tau);
  const Finding finding = oracle_.check(motion.tip, to, verdict.threshold, kept + 4.0 * tau);
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

}  // namespace keepout::oracle
