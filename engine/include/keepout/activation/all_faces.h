// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/activation/activation_rule.h"

namespace keepout {

/// Every triangle in reach whose positive side the tip is on becomes a plane: the naive baseline of
/// Li et al. 2020 (figure 2d), right in valleys and far too strict over ridges. Triangles without
/// an area have no face and are passed over.
class AllFaces final : public ActivationRule {
 public:
  Opening open(const RuleInput& input, HalfSpaceBuffer& planes) noexcept override;
};

}  // namespace keepout
