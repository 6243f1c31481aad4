// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/pd_tree.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace keepout {
namespace {

constexpr std::uint32_t leaf_size = 6;

// The exact kernel and the box test round differently, each by some 1e-15 of the lengths involved.
// A box is passed over only when it is farther away than the radius by clearly more than that.
constexpr double rounding = 1e-13;

/// Orthonormal rows, the direction of largest spread first. The eigenvectors only choose the frame;
/// the cross products make it orthonormal to rounding, which the box test relies on.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  if (solver.info() == Eigen::Success && solver.eigenvectors().allFinite()) {
    const Vec3 first = solver.eigenvectors().col(2).normalized();
    const Vec3 second = first.cross(solver.eigenvectors().col(1)).cross(first).normalized();
    axes.row(0) = first;
    axes.row(1) = second;
    axes.row(2) = first.cross(second);
  }
  return axes;
}

}  // namespace

PdTree::PdTree(std::shared_ptr<const Mesh> mesh) : mesh_(std::move(mesh)) {
  const auto count = static_cast<std::uint32_t>(mesh_->triangle_count());
  triangles_.resize(count);
  std::iota(triangles_.begin(), triangles_.end(), TriangleId{0});
  std::vector<Vec3> centroids(count);
  for (TriangleId t = 0; t < count; ++t) {
    const Triangle corners = mesh_->triangle(t);
    centroids[t] = (corners[0] + corners[1] + corners[2]) / 3.0;
  }
  nodes_.reserve(count / 2 + 1);
  build(0, count, centroids);
  nodes_.shrink_to_fit();
}

std::uint32_t PdTree::build(std::uint32_t begin, std::uint32_t end,
                            std::span<const Vec3> centroids) {
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back(enclose(begin, end, centroids));
  if (end - begin <= leaf_size) return self;

  const Vec3 direction = nodes_[self].axes.row(0);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle,
                   triangles_.begin() + end, [&](TriangleId a, TriangleId b) {
                     return direction.dot(centroids[a]) < direction.dot(centroids[b]);
                   });
  build(begin, middle, centroids);
  const std::uint32_t far_child = build(middle, end, centroids);
  nodes_[self].far_child = far_child;
  return self;
}

PdTree::Node PdTree::enclose(std::uint32_t begin, std::uint32_t end,
                             std::span<const Vec3> centroids) const {
  const std::span inside(triangles_.data() + begin, end - begin);
  Vec3 mean = Vec3::Zero();
  for (const TriangleId t : inside) mean += centroids[t];
  mean /= static_cast<double>(inside.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const TriangleId t : inside) {
    const Vec3 from_mean = centroids[t] - mean;
    covariance += from_mean * from_mean.transpose();
  }

  Node node{principal_axes(covariance), mean, Vec3::Zero(), begin, end, 0};
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();
  for (const TriangleId t : inside) {
    for (const VertexId v : mesh_->corners(t)) {
      const Vec3 local = node.axes * (mesh_->vertex(v) - mean);
      low = low.cwiseMin(local);
      high = high.cwiseMax(local);
    }
  }
  node.center += node.axes.transpose() * (0.5 * (low + high));
  node.half = 0.5 * (high - low);
  // Rounding of the centre, which is that of the mesh's own coordinates, goes into the box.
  node.half.array() += rounding * (node.half.maxCoeff() + mean.cwiseAbs().maxCoeff());
  return node;
}

void PdTree::collect(const Ball& ball, TriangleBuffer& candidates) const noexcept {
  // Twice as deep as the tree can be: the split at the median halves 2^32 triangles 32 times.
  std::array<std::uint32_t, 64> stack;
  int waiting = 0;
  std::uint32_t n = 0;
  for (;;) {
    const Node& node = nodes_[n];
    const Vec3 local = node.axes * (ball.center - node.center);
    const Vec3 beyond = (local.cwiseAbs() - node.half).cwiseMax(0.0);
    const double slack = rounding * (local.cwiseAbs().sum() + node.half.sum() + ball.radius);
    const double reach = ball.radius + slack;
    if (beyond.squaredNorm() <= reach * reach) {
      if (node.far_child != 0) {
        stack[waiting++] = node.far_child;
        ++n;
        continue;
      }
      for (std::uint32_t i = node.begin; i < node.end; ++i) candidates.push(triangles_[i]);
    }
    if (waiting == 0) return;
    n = stack[--waiting];
  }
}

std::size_t PdTree::memory() const noexcept {
  return nodes_.capacity() * sizeof(Node) + triangles_.capacity() * sizeof(TriangleId);
}

}  // namespace keepout
