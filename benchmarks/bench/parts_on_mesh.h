// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulate/simulate.h"

namespace keepout::app {

/// Times all indices, rules and solvers on the mesh of a simulation, quickly, and compares their
/// answers. A signal stops it, and it keeps what is finished.
PartTimings time_parts(const SimulateOptions& options, const std::shared_ptr<const Mesh>& mesh,
                       std::ostream& out);

}  // namespace keepout::app
