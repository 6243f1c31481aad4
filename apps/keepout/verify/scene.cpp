// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "keepout/adapters/index_registry.h"
#include "keepout/mesh/doctor.h"

namespace keepout::app {

Scene::Scene(std::string name, Surface surface, std::string_view index)
    : Scene(std::move(name), std::make_shared<const Mesh>(std::move(surface)), index) {}

Scene::Scene(std::string name, std::shared_ptr<const Mesh> mesh, std::string_view index)
    : name_(std::move(name)),
      mesh_(std::move(mesh)),
      index_(make_index(index, mesh_)),
      oracle_(mesh_),
      nearest_(*mesh_, *index_),
      has_sides_(is_watertight(*mesh_)) {
  const Vec3 center = mesh_->bounds().center();
  double sum = 0.0;
  double volume = 0.0;
  for (TriangleId t = 0; t < mesh_->triangle_count(); ++t) {
    const Triangle c = mesh_->triangle(t);
    for (int e = 0; e < 3; ++e) {
      const double edge = (c[(e + 1) % 3] - c[e]).norm();
      sum += edge;
      longest_edge_ = std::max(longest_edge_, edge);
      farthest_ = std::max(farthest_, c[e].lpNorm<1>());
    }
    volume += (c[0] - center).dot((c[1] - center).cross(c[2] - center));
  }
  mean_edge_ = sum / (3.0 * static_cast<double>(mesh_->triangle_count()));
  if (!(mean_edge_ > 0.0)) mean_edge_ = 1.0;  // all triangles are points
  free_inside_ = volume < 0.0;
}

bool Scene::is_forbidden(const Vec3& point) const {
  return oracle_.inside(point).value() != free_inside_;
}

}  // namespace keepout::app
