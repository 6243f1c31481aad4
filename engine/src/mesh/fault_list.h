// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <initializer_list>
#include <vector>

#include "keepout/mesh/fault_places.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// All faults of one kind, each by its vertices.
class FaultList {
 public:
  /// `corners`: the number of vertices of each fault.
  explicit FaultList(std::size_t corners) : corners_(corners) {}

  /// Adds a fault. Precondition: it has as many vertices as the constructor was given.
  void add(std::initializer_list<VertexId> vertices) {
    vertices_.insert(vertices_.end(), vertices);
  }

  std::size_t size() const noexcept { return vertices_.size() / corners_; }

  /// Returns the number of groups of the faults, and the places of at most `most` faults.
  FaultPlaces places(const Mesh& mesh, std::size_t most) const;

 private:
  /// Returns for each fault the number of the first fault in its group.
  std::vector<std::size_t> groups() const;

  std::size_t corners_;
  std::vector<VertexId> vertices_ = {};
};

}  // namespace keepout
