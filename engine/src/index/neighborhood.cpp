// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/neighborhood.h"

#include <algorithm>
#include <utility>

#include "keepout/error.h"

namespace keepout {
namespace {

std::size_t room_for(const Mesh* mesh, const SpatialIndex* index, std::size_t asked) {
  if (mesh == nullptr || index == nullptr) {
    throw Error("a query needs a mesh and an index: one of them was not given");
  }
  return std::min(asked, mesh->triangle_count());
}

}  // namespace

Neighborhood::Neighborhood(std::shared_ptr<const Mesh> mesh,
                           std::shared_ptr<const SpatialIndex> index, std::size_t room)
    : mesh_(std::move(mesh)),
      index_(std::move(index)),
      candidates_(room_for(mesh_.get(), index_.get(), room)),
      hits_(candidates_.capacity()) {}

bool Neighborhood::look(const Ball& ball) noexcept {
  ball_ = ball;
  candidates_.clear();
  hits_.clear();
  if (!ball.center.allFinite() || !(ball.radius >= 0.0)) return false;
  index_->collect(ball, candidates_);
  if (candidates_.overflowed()) return false;
  refine(*mesh_, ball, candidates_.view(), hits_);
  return true;
}

}  // namespace keepout
