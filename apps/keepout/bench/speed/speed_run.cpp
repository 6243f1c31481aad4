// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/speed_run.h"

#include <ostream>
#include <utility>

#include "bench/speed/speed_table.h"

namespace keepout::app {

void SpeedRun::show(const std::string& work) { progress.show(work); }

void SpeedRun::add(SpeedRow row) {
  progress.interrupt();
  print_row(out, row);
  out.flush();
  record.rows.push_back(std::move(row));
}

SpeedRow ratio(std::string work, std::string compared, const Demand& demand,
               const std::optional<MeasuredSide>& numerator,
               const std::optional<MeasuredSide>& denominator) {
  SpeedRow row{.work = std::move(work), .compared = std::move(compared), .demand = demand};
  for (const auto* side : {&numerator, &denominator}) {
    if (*side) row.sides.push_back(**side);
  }
  if (numerator && denominator) row.figure = numerator->us.p50 / denominator->us.p50;
  return row;
}

}  // namespace keepout::app
