// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/certified_contact.h"

#include <utility>

#include "bench/speed/pressed_motions.h"
#include "bench/speed/stopwatch.h"
#include "number_text.h"

namespace keepout::app {

std::string name_of(const Contact& contact) {
  return "margin " + trimmed(contact.margin) + " mm, motion " + trimmed(contact.shortest) + "-" +
         trimmed(contact.longest) + " mm";
}

std::vector<Motion> contact_motions_of(const SpeedRun& run, const IndexedMesh& on,
                                       const Contact& contact) {
  Random random = run.random();
  return pressed_motions(
      on, run.settings.effort.steps,
      {.clearance = contact.margin, .shortest = contact.shortest, .longest = contact.longest},
      random);
}

CertifiedSide time_certified(SpeedRun& run, const IndexedMesh& on, const std::string& name,
                             double margin, std::span<const Motion> motions) {
  Stepper ours = certified(on, margin, Form::searching);
  if (ours.searches()) {
    Stepper plain = certified(on, margin, Form::plain);
    if (std::string remark = disagreement(ours, plain, motions); !remark.empty()) {
      return {.remark = std::move(remark)};
    }
  }
  return {.side = timed(name, motions.size(), run.settings.effort.passes,
                        [&](std::size_t i) { ours.ask(motions[i]); }),
          .remark = ours.searches() ? "" : plain_form_remark};
}

CertifiedSide in_contact(SpeedRun& run, const IndexedMesh& on, const Contact& contact) {
  const std::string name = name_of(contact);
  run.show("certified, contact, " + name);
  return time_certified(run, on, name, contact.margin, contact_motions_of(run, on, contact));
}

SpeedRow with_remark(SpeedRow row, const CertifiedSide& side) {
  row.remark = side.remark;
  return row;
}

}  // namespace keepout::app
