// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "urdf_chain.h"

namespace keepout {

/// A link of a URDF on a link of the chain: the number of the latter, and the pose of the former in
/// its frame.
struct LinkPlace {
  int link = 0;
  Pose pose = {};
};

/// The place of a link, or the reason why the chain does not carry it.
struct FoundPlace {
  std::optional<LinkPlace> place = std::nullopt;
  std::string moved_by = {};  // the joint outside of the chain that moves it; empty: not below the
                              // base
};

/// Finds the place of a link: of the chain itself, or fixed to a link of it. `scale`: the length of
/// a meter. Precondition: the link is one of the model.
FoundPlace place_of(const urdf::LinkConstSharedPtr& link, const UrdfChain& chain, double scale);

}  // namespace keepout
