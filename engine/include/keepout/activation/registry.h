// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string_view>

#include "keepout/activation/activation_rule.h"
#include "keepout/registry.h"

namespace keepout {

/// A rule by name.
struct ActivationEntry {
  std::string_view name;         // to ask for it by
  std::string_view description;  // one line, for lists
  /// A new rule.
  std::unique_ptr<ActivationRule> (*make)();
};

/// All rules, in the order in which they should be listed.
Registry<ActivationEntry> activation_rules() noexcept;

/// Throws Error, listing the known names, for an unknown one.
std::unique_ptr<ActivationRule> make_activation(std::string_view name);

}  // namespace keepout
