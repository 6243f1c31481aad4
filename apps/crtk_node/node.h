// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "transport.h"

namespace keepout::crtk {

/// A process on a transport, which the loop calls once each period.
class Node : public Inbox {
 public:
  /// Runs one cycle. `now`: seconds since 1970.
  virtual void cycle(double now) = 0;
  /// Returns lines on what happened, for the end of the process.
  virtual std::string summary() const = 0;
};

}  // namespace keepout::crtk
