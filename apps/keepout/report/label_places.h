// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace keepout::app {

/// Heights for labels one below another: in the order in which they want to be, `gap` apart, and
/// all together as near as can be (least squares) to where they want to be, within low..high.
/// Where there is no room for that, the gaps shrink.
std::vector<double> label_places(const std::vector<double>& wanted, double gap, double low,
                                 double high);

}  // namespace keepout::app
