// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string_view>

#include "keepout/activation/activation_rule.h"
#include "keepout/registry.h"

namespace keepout {

/// A rule, to be made by its name.
struct ActivationEntry {
  std::string_view name;         // for make_activation
  std::string_view description;  // one line, for lists
  /// Makes a new rule.
  std::unique_ptr<ActivationRule> (*make)();
};

/// Returns all rules, in the order of lists.
Registry<ActivationEntry> activation_rules() noexcept;

/// Returns a new rule of that name. Throws Error, which lists the known names, for an unknown name.
std::unique_ptr<ActivationRule> make_activation(std::string_view name);

}  // namespace keepout
