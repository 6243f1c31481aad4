// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "bench/speed/speed_record.h"

namespace keepout::app {

/// Writes the table of ratios and the histogram of step times as one HTML page that needs nothing
/// but itself.
void print_speed_report(std::ostream& out, const SpeedRecord& record);

}  // namespace keepout::app
