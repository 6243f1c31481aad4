// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bench/speed/speed_record.h"

namespace keepout::app {

/// Steps and empty loop, how many took how long: an <svg> element, both axes logarithmic.
std::string counts_plot(const StepHistogram& histogram);

/// The same as how many of a million took longer.
std::string tail_plot(const StepHistogram& histogram);

}  // namespace keepout::app
