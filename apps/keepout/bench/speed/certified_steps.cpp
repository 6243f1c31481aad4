// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/speed/certified_contact.h"
#include "bench/speed/families.h"
#include "bench/speed/free_motions.h"

namespace keepout::app {

void measure_certified_steps(SpeedRun& run, const IndexedMesh& on) {
  const std::size_t count = run.settings.effort.steps;
  const CertifiedSide contact = in_contact(run, on, {});
  run.baselines.contact = contact.side;
  run.add(with_remark(ratio("certified step in contact, motion .05-.2 mm, margin .2 mm",
                            "(FCL's tree + SLSQP, paper's rule, r = 5 mm) / ours", at_least(500.0),
                            run.baselines.libraries, contact.side),
                      contact));

  run.show("certified, free space");
  Random random = run.random();
  const std::vector<Motion> path = free_motions(*on.mesh, *on.index, count, {}, {}, random);
  const CertifiedSide free = time_certified(run, on, "free space", small_margin, path);
  run.baselines.free = free.side;
  run.add(with_remark(ratio("certified step in free space, 2-20 mm off the surface",
                            "(FCL's tree + SLSQP, paper's rule, r = 5 mm) / ours", at_least(5000.0),
                            run.baselines.libraries, free.side),
                      free));

  const CertifiedSide wide = in_contact(run, on, {.margin = 5.0});
  run.add(with_remark(ratio("certified in contact", "margin 5 mm / margin .2 mm", at_most(3.0),
                            wide.side, contact.side),
                      wide));

  const CertifiedSide fast = in_contact(run, on, {.shortest = 1.0, .longest = 5.0});
  run.add(
      with_remark(ratio("certified in contact, margin .2 mm", "motion 1-5 mm / motion .05-.2 mm",
                        at_most(3.0), fast.side, contact.side),
                  fast));
}

}  // namespace keepout::app
