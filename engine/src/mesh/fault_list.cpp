// SPDX-License-Identifier: BSD-3-Clause
#include "fault_list.h"

#include <algorithm>
#include <utility>

#include "disjoint_sets.h"

namespace keepout {

std::vector<std::size_t> FaultList::groups() const {
  DisjointSets sets(size());
  std::vector<std::pair<VertexId, std::size_t>> uses;
  uses.reserve(vertices_.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i) uses.emplace_back(vertices_[i], i / corners_);
  std::sort(uses.begin(), uses.end());
  for (std::size_t i = 1; i < uses.size(); ++i) {
    if (uses[i].first == uses[i - 1].first) sets.join(uses[i].second, uses[i - 1].second);
  }
  std::vector<std::size_t> first(size());
  for (std::size_t fault = 0; fault < size(); ++fault) first[fault] = sets.find(fault);
  return first;
}

FaultPlaces FaultList::places(const Mesh& mesh, std::size_t most) const {
  FaultPlaces result;
  const std::vector<std::size_t> first = groups();
  std::vector<std::size_t> chosen;
  std::vector<std::size_t> others;
  for (std::size_t fault = 0; fault < size(); ++fault) {
    const bool is_first = first[fault] == fault;
    if (is_first) ++result.groups;
    std::vector<std::size_t>& list = is_first ? chosen : others;
    if (list.size() < most) list.push_back(fault);
  }
  others.resize(std::min(others.size(), most - chosen.size()));
  chosen.insert(chosen.end(), others.begin(), others.end());
  for (const std::size_t fault : chosen) {
    FaultPlace& place = result.places.emplace_back(FaultPlace{Vec3::Zero(), {}});
    for (std::size_t i = 0; i < corners_; ++i) {
      place.corners.push_back(mesh.vertex(vertices_[corners_ * fault + i]));
      place.at += place.corners.back() / static_cast<double>(corners_);
    }
  }
  return result;
}

}  // namespace keepout
