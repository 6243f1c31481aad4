// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "compare/comparison.h"

namespace keepout::app {

// What a comparison came to, in words, all of it computed from the rows. Of rows that there are:
// each function but the first two needs one.

/// No index may differ in any bit, no solver be wrong; the narrow phases are not ours.
bool agree(const Comparison& comparison);

/// A paragraph for each kind of part that was compared, then whether those agree that must.
std::vector<std::string> verdict(const Comparison& comparison);

/// On queries and steps, in one sentence.
std::string index_verdict(const std::vector<IndexAgreement>& rows);
/// Equal steps are no finding where they could not be otherwise: on where that is so.
std::string index_agreement_by_construction(const std::vector<IndexAgreement>& rows);
/// On answers, and on why some solvers got fewer problems.
std::string solver_verdict(const std::vector<SolverAgreement>& rows);
/// On distances.
std::string narrow_phase_verdict(const std::vector<NarrowPhaseAgreement>& rows);

}  // namespace keepout::app
