// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/stopwatch.h"

namespace keepout::app {
namespace {

void lower(double& least, double value) { least = std::min(least, value); }

void lower(std::optional<double>& least, const std::optional<double>& value) {
  if (least && value) lower(*least, *value);
}

}  // namespace

void Passes::add(std::vector<double>& samples) {
  const Timing timing = timing_of(samples);
  if (!least_) {
    least_ = timing;
    return;
  }
  lower(least_->p50, timing.p50);
  lower(least_->p99, timing.p99);
  lower(least_->p999, timing.p999);
  lower(least_->max, timing.max);
}

}  // namespace keepout::app
