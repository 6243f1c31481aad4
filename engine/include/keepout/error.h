// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace keepout {

/// The exception that constructors and builders throw. Its message names the faulty input and the
/// remedy. No function of the control path throws: a step returns a status instead.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace keepout
