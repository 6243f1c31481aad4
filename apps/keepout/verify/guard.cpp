// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "guard.h"

#include <algorithm>

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
  const bool asks = inside == Inside::led_out && scene_->has_sides();
  sides_ = asks ? SideWatch::of_watertight() : SideWatch();
}

Step CertifiedGuard::step(const Motion& motion) noexcept {
  return keepout::step(sides_, *scene_->mesh(), scene_->index(), rule_, solver_, motion, options_,
                       work_);
}

std::unique_ptr<Guard> make_certified_guard(const Scene& scene) {
  return std::make_unique<CertifiedGuard>(scene);
}

}  // namespace keepout::app
