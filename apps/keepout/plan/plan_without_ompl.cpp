// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/error.h"
#include "plan/plan.h"

namespace keepout::app {

int plan(const PlanOptions&, std::ostream&) {
  throw Error(
      "plan: keepout was built without OMPL. Install libompl-dev, then configure and build again "
      "with -DKEEPOUT_WITH_OMPL=ON and no sanitizers");
}

}  // namespace keepout::app
