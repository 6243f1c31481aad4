// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace keepout {

/// What construction throws: the message names the thing at fault and what to do about it.
/// Nothing on the control path throws; a step returns a status instead.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace keepout
