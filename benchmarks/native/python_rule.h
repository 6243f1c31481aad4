// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <utility>

#include "rules/rule.h"

namespace keepout::peers {

/// A rule of Python: an object with step(tip, desired). Takes Python's lock for each step.
class PythonRule : public Rule {
 public:
  explicit PythonRule(pybind11::object rule) : rule_(std::move(rule)) {}

  Vec3 step(const Vec3& tip, const Vec3& desired) override {
    const pybind11::gil_scoped_acquire lock;
    return rule_.attr("step")(tip, desired).cast<Vec3>();
  }

 private:
  pybind11::object rule_;
};

/// The argument `rule` of a loop: a rule of C++ or of Python, or None. Precondition: Python's lock
/// is held when this is made and destroyed.
class RuleArgument {
 public:
  explicit RuleArgument(const pybind11::object& rule) {
    if (pybind11::isinstance<Rule>(rule)) {
      rule_ = rule.cast<Rule*>();
    } else if (!rule.is_none()) {
      rule_ = &of_python_.emplace(rule);
    }
  }
  RuleArgument(const RuleArgument&) = delete;
  RuleArgument& operator=(const RuleArgument&) = delete;

  /// Returns null for None.
  Rule* rule() const noexcept { return rule_; }

 private:
  std::optional<PythonRule> of_python_;
  Rule* rule_ = nullptr;
};

}  // namespace keepout::peers
