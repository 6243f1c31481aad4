// SPDX-License-Identifier: BSD-3-Clause
#include "closest_point_planes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "keepout/error.h"
#include "keepout/index/query.h"
#include "nearest_motion.h"

namespace keepout::peers {
namespace {

/// A vertex or an edge of the mesh, by the numbers of its ends; the same for all its triangles.
using SharedFeature = std::uint64_t;

SharedFeature edge(VertexId a, VertexId b) {
  return SharedFeature{std::min(a, b)} << 32 | std::max(a, b);
}

/// Precondition: the feature is not the inside of the triangle.
SharedFeature shared(const Corners& corners, Feature feature) {
  const int i = number_of(feature);
  return edge(corners[i], corners[is_vertex(feature) ? i : (i + 1) % 3]);
}

constexpr std::array shared_features{Feature::edge_0,   Feature::edge_1,   Feature::edge_2,
                                     Feature::vertex_0, Feature::vertex_1, Feature::vertex_2};

class ClosestPointPlanes : public Rule {
 public:
  ClosestPointPlanes(const Task& task, Obstacles obstacles, double gain)
      : task_(task),
        obstacles_(obstacles),
        gain_(gain),
        near_(task.index->shared_mesh(), task.index, task.mesh().triangle_count(), budget_) {}

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
    // The triangles around a shared feature that have not got it as their nearest point.
    disagreeing_.clear();
    for (const Hit& hit : hits) {
      const Corners& corners = task_.mesh().corners(hit.triangle);
      if (!is_face(hit.closest.feature)) disagreeing_[shared(corners, hit.closest.feature)] = 0;
    }
    for (const Hit& hit : hits) {  // all triangles around such a feature are hits
      const Corners& corners = task_.mesh().corners(hit.triangle);
      for (const Feature f : shared_features) {
        const auto found = disagreeing_.find(shared(corners, f));
        if (found != disagreeing_.end() && f != hit.closest.feature) ++found->second;
      }
    }
    for (const Hit& hit : hits) {
      if (is_face(hit.closest.feature)) {
        chosen_.push_back(hit);
        continue;
      }
      int& disagreeing =
          disagreeing_[shared(task_.mesh().corners(hit.triangle), hit.closest.feature)];
      if (disagreeing++ == 0) chosen_.push_back(hit);  // once for all its triangles
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
  std::unordered_map<SharedFeature, int> disagreeing_;
  std::vector<Hit> chosen_;
  NearestMotion planes_;
};

}  // namespace

std::unique_ptr<Rule> closest_point_planes(const Task& task, Obstacles obstacles, double gain) {
  if (!(gain > 0.0 && gain <= 1.0)) throw Error("the gain must be above 0 and at most 1");
  return std::make_unique<ClosestPointPlanes>(task, obstacles, gain);
}

}  // namespace keepout::peers
