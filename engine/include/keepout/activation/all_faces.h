// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/activation/activation_rule.h"

namespace keepout {

/// Adds a plane for every triangle in the region if the tip is on its positive side. This is the
/// naive baseline of Li et al. (2020), figure 2d: correct in valleys, and far too strict over
/// ridges. Ignores triangles without an area, which have no face.
class AllFaces final : public ActivationRule {
 public:
  Opening open(const RuleInput& input, HalfSpaceBuffer& planes) noexcept override;
};

}  // namespace keepout
