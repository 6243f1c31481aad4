// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "guard.h"

#include <algorithm>

#include "keepout/step/placement.h"

namespace keepout::app {
namespace {

Capacity capacity_for(const Mesh& mesh) {
  return {.triangles = std::min<std::size_t>(std::size_t{1} << 16, mesh.triangle_count()),
          .planes = 256,
          .variables = 7,
          .extra_rows = 14,
          .nodes = 16};
}

}  // namespace

CertifiedGuard::CertifiedGuard(const Scene& scene)
    : scene_(&scene), rule_(scene.mesh()), work_(capacity_for(*scene.mesh())) {
  const Capacity capacity = capacity_for(*scene.mesh());
  rule_.reserve(capacity.triangles);
  solver_.reserve(static_cast<int>(capacity.variables),
                  static_cast<int>(capacity.planes + capacity.extra_rows));
}

void CertifiedGuard::begin(const StepOptions& options, Inside inside) {
  options_ = options;
  has_sides_ = inside == Inside::led_out && scene_->has_sides();
  free_tip_ = Motion::unset;
}

Step CertifiedGuard::step(const Motion& motion) noexcept {
  const Mesh& mesh = *scene_->mesh();
  const SpatialIndex& index = scene_->index();
  const bool is_placed = motion.jacobian || motion.rows || motion.tip == free_tip_;
  if (has_sides_ && !is_placed && is_ok(check(motion, options_))) {
    const std::optional<Placement> placement = place(mesh, index, motion.tip, work_.candidates);
    Step out;
    if (!placement) {
      out.status = Status::over_capacity;
      return out;
    }
    if (placement->side == Placement::Side::forbidden) {
      out.status = Status::recovering;
      out.motion = lead_out(*placement, options_.recovery);
      return out;
    }
  }
  const Step result = keepout::step(mesh, index, rule_, solver_, motion, options_, work_);
  free_tip_ = motion.tip + result.motion;
  return result;
}

std::unique_ptr<Guard> make_certified_guard(const Scene& scene) {
  return std::make_unique<CertifiedGuard>(scene);
}

}  // namespace keepout::app
