// SPDX-License-Identifier: BSD-3-Clause
#include "terrain.h"

#include <algorithm>
#include <numeric>

#include "keepout/index/wide_bvh.h"
#include "keepout/mesh/adjacency.h"
#include "keepout/mesh/diagnostics.h"

namespace keepout::peers {
namespace {

constexpr double cosine_of_rim = 0.5;          // 60 degrees
constexpr double cosine_of_saddle = 0.996195;  // 5 degrees

}  // namespace

Terrain::Terrain(const std::shared_ptr<const Mesh>& mesh)
    : index_(std::make_shared<WideBvh>(mesh)),
      judge_(mesh),
      is_inside_out_(examine(*mesh, 0).is_inside_out()),
      kinds_(mesh->vertex_count(), Kind::plain),
      all_(mesh->triangle_count()) {
  std::iota(all_.begin(), all_.end(), TriangleId{0});
  const Adjacency adjacency(*mesh);
  std::vector<bool> convex(kinds_.size()), concave(kinds_.size()), rim(kinds_.size());
  for (const TriangleId t : all_) {
    for (int edge = 0; edge < 3; ++edge) {
      const EdgeKind kind = adjacency.kind(t, edge);
      if (kind != EdgeKind::convex && kind != EdgeKind::concave) continue;
      const double cosine = mesh->normal(t).dot(mesh->normal(adjacency.neighbor(t, edge)));
      if (cosine >= cosine_of_saddle) continue;
      for (const int end : {edge, (edge + 1) % 3}) {
        const VertexId v = mesh->corners(t)[end];
        (kind == EdgeKind::convex ? convex : concave)[v] = true;
        if (kind == EdgeKind::convex && cosine < cosine_of_rim) rim[v] = true;
      }
    }
  }
  for (VertexId v = 0; v < kinds_.size(); ++v) {
    if (convex[v] && concave[v]) {
      kinds_[v] = Kind::saddle;
    } else if (rim[v]) {
      kinds_[v] = Kind::rim;
    }
  }
  const auto has = [&](TriangleId t, Kind kind) {
    const Corners& corners = mesh->corners(t);
    return std::any_of(corners.begin(), corners.end(),
                       [&](VertexId v) { return kinds_[v] == kind; });
  };
  for (const TriangleId t : all_) {
    if (has(t, Kind::rim)) at_rims_.push_back(t);
    if (has(t, Kind::saddle)) at_saddles_.push_back(t);
  }
}

Vec3 Terrain::place(Kind kind, double clearance, double height, Random& random) const {
  constexpr int attempts = 400;
  const std::vector<TriangleId>& chosen = kind == Kind::rim ? at_rims_ : at_saddles_;
  const std::vector<TriangleId>& triangles = kind == Kind::plain || chosen.empty() ? all_ : chosen;
  Judge judge = judge_;
  double up = height;
  for (int attempt = 0; attempt < attempts; ++attempt, up *= 0.98) {
    const TriangleId t = triangles[random.below(triangles.size())];
    const Triangle corners = mesh().triangle(t);
    const double u = random.uniform(), v = random.uniform() * (1.0 - u);
    Vec3 below = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
    if (kind != Kind::plain) {
      for (int i = 0; i < 3; ++i) {
        if (kinds_[mesh().corners(t)[i]] == kind) below = 0.1 * below + 0.9 * corners[i];
      }
    }
    const Vec3 way = (mesh().normal(t) + 0.5 * random.direction()).normalized();
    const Vec3 place = below + up * way;
    const double distance = judge.distances(place.transpose())[0];
    const bool is_free = !judge.closed() || (distance < 0.0) == is_inside_out_;
    if (is_free && std::abs(distance) > std::max(clearance, 0.5 * up)) return place;
  }
  throw Error("no place outside has the required clearance");
}

}  // namespace keepout::peers
