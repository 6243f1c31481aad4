// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>

#include "keepout/index/spatial_index.h"

namespace keepout {

/// An index that only answers queries, whatever else the one behind it offers.
class QueriesOnly final : public SpatialIndex {
 public:
  explicit QueriesOnly(const std::shared_ptr<const SpatialIndex>& index)
      : SpatialIndex(index->shared_mesh()), index_(index) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    index_->collect(ball, candidates);
  }
  std::size_t memory() const noexcept override { return index_->memory(); }

 private:
  std::shared_ptr<const SpatialIndex> index_;
};

}  // namespace keepout
