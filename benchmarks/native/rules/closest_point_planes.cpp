// SPDX-License-Identifier: BSD-3-Clause
#include "closest_point_planes.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "keepout/error.h"
#include "keepout/index/query.h"
#include "nearest_motion.h"

namespace keepout::peers {
namespace {

/// Counts the triangles around each vertex and each edge.
class TriangleCounts {
 public:
  explicit TriangleCounts(const Mesh& mesh) {
    for (const Corners& corners : mesh.triangles()) {
      for (int i = 0; i < 3; ++i) {
        ++counts_[vertex(corners[i])];
        ++counts_[edge(corners[i], corners[(i + 1) % 3])];
      }
    }
  }

  /// Returns the number of the feature of a triangle: a vertex, an edge, or 0 for its inside.
  static std::uint64_t feature_of(const Corners& corners, Feature feature) {
    if (is_face(feature)) return 0;
    const int i = number_of(feature);
    return is_vertex(feature) ? vertex(corners[i]) : edge(corners[i], corners[(i + 1) % 3]);
  }
  int operator()(std::uint64_t feature) const { return counts_.at(feature); }

 private:
  static std::uint64_t vertex(VertexId v) { return edge(v, v); }
  static std::uint64_t edge(VertexId a, VertexId b) {
    return (std::uint64_t{std::min(a, b)} << 32 | std::max(a, b)) + 1;
  }

  std::unordered_map<std::uint64_t, int> counts_;
};

class ClosestPointPlanes : public Rule {
 public:
  ClosestPointPlanes(const Task& task, Obstacles obstacles, double gain)
      : task_(task),
        obstacles_(obstacles),
        gain_(gain),
        near_(task.index->shared_mesh(), task.index, task.mesh().triangle_count(), budget_) {
    if (obstacles == Obstacles::minima) counts_.emplace(task.mesh());
  }

  Vec3 step(const Vec3& tip, const Vec3& desired) override {
    planes_.begin(task_.corridor, tip);
    budget_.renew();
    if (!near_.gather({tip, task_.margin + desired.norm() / gain_})) return Vec3::Zero();
    choose();
    const double sign = is_outside() ? 1.0 : -1.0;
    for (const Hit& hit : chosen_) {
      const double distance = sign * hit.closest.distance;
      const Vec3 normal = distance == 0.0 ? task_.mesh().normal(hit.triangle)
                                          : Vec3(-hit.closest.offset / distance);
      planes_.add(normal, std::min(-gain_ * (distance - task_.margin), recovery));
    }
    return planes_.to(desired);
  }

 private:
  static bool is_nearer(const Hit& a, const Hit& b) {
    return a.closest.distance < b.closest.distance;
  }

  void choose() {
    const std::span<const Hit> hits = near_.hits();
    chosen_.clear();
    if (obstacles_ == Obstacles::all) chosen_.assign(hits.begin(), hits.end());
    if (obstacles_ == Obstacles::nearest && !hits.empty()) {
      chosen_.push_back(*std::min_element(hits.begin(), hits.end(), is_nearer));
    }
    if (obstacles_ != Obstacles::minima) return;
    agreeing_.clear();
    for (const Hit& hit : hits) {
      const std::uint64_t feature =
          TriangleCounts::feature_of(task_.mesh().corners(hit.triangle), hit.closest.feature);
      if (feature == 0 || ++agreeing_[feature] == (*counts_)(feature)) chosen_.push_back(hit);
    }
  }

  /// Decides by the sum of the normals of the triangles that have the nearest point. This is the
  /// pseudonormal of Baerentzen and Aanaes (2005) without the weights by angle. It is as correct if
  /// the faces around the point turn by no more than a right angle.
  bool is_outside() const {
    const std::span<const Hit> hits = near_.hits();
    if (hits.empty()) return true;
    const Hit& nearest = *std::min_element(hits.begin(), hits.end(), is_nearer);
    Vec3 away = Vec3::Zero();
    for (const Hit& hit : hits) {
      if (hit.closest.distance <= nearest.closest.distance * (1.0 + 1e-9)) {
        away += task_.mesh().normal(hit.triangle);
      }
    }
    return nearest.closest.offset.dot(away) <= 0.0;
  }

  Task task_;
  Obstacles obstacles_;
  double gain_;
  Budget budget_;
  Neighborhood near_;
  std::optional<TriangleCounts> counts_;
  std::unordered_map<std::uint64_t, int> agreeing_;
  std::vector<Hit> chosen_;
  NearestMotion planes_;
};

}  // namespace

std::unique_ptr<Rule> closest_point_planes(const Task& task, Obstacles obstacles, double gain) {
  if (!(gain > 0.0 && gain <= 1.0)) throw Error("the gain must be above 0 and at most 1");
  return std::make_unique<ClosestPointPlanes>(task, obstacles, gain);
}

}  // namespace keepout::peers
