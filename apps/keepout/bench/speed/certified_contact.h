// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/speed/speed_run.h"

namespace keepout::app {

inline constexpr double small_margin = 0.2;  // [mm]

/// A tool that slides along the surface, at the margin. [mm]
struct Contact {
  double margin = small_margin;
  double shortest = 0.05, longest = 0.2;  // of the motions asked for
};

/// What certified steps took; missing where they are not those of the plain rule, bit for bit.
struct CertifiedSide {
  std::optional<MeasuredSide> side = {};
  std::string remark = {};
};

/// Our certified step on these motions.
CertifiedSide time_certified(SpeedRun& run, const IndexedMesh& on, const std::string& name,
                             double margin, std::span<const Motion> motions);

/// The same on a tool in contact.
CertifiedSide in_contact(SpeedRun& run, const IndexedMesh& on, const Contact& contact);

/// As many motions as our steps are timed on.
std::vector<Motion> contact_motions_of(const SpeedRun& run, const IndexedMesh& on,
                                       const Contact& contact);

/// "margin .2 mm, motion 1-5 mm"
std::string name_of(const Contact& contact);

SpeedRow with_remark(SpeedRow row, const CertifiedSide& side);

/// Of rows whose rule has no form of its own for our index.
inline constexpr const char* plain_form_remark = "the rule does not search the index by itself";

}  // namespace keepout::app
