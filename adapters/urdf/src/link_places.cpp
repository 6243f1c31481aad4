// SPDX-License-Identifier: BSD-3-Clause
#include "link_places.h"

#include <algorithm>

namespace keepout {

FoundPlace place_of(const urdf::LinkConstSharedPtr& link, const UrdfChain& chain, double scale) {
  LinkPlace place;
  std::string moved_by;
  for (urdf::LinkConstSharedPtr at = link; at != nullptr; at = at->getParent()) {
    const auto found = std::ranges::find(chain.links, at->name);
    if (found != chain.links.end()) {
      if (!moved_by.empty()) return {.moved_by = moved_by};
      place.link = static_cast<int>(found - chain.links.begin());
      return {.place = place};
    }
    if (at->parent_joint == nullptr) break;
    if (at->parent_joint->type != urdf::Joint::FIXED) moved_by = at->parent_joint->name;
    place.pose = pose_of(at->parent_joint->parent_to_joint_origin_transform, scale) * place.pose;
  }
  return {};
}

}  // namespace keepout
