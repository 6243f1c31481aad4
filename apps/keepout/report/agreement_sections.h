// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>

#include "compare/comparison.h"

namespace keepout::app {

/// How well indices, solvers and narrow phases agree with what is known to be right: a sentence and
/// a table each. A section without rows is left out.

/// The one sentence of a page that has nothing else. Plain text, not yet escaped. Precondition: the
/// comparison has a row.
std::string agreement_headline(const Comparison& comparison);

void print_index_agreement(std::ostream& out, const Comparison& comparison);
void print_solver_agreement(std::ostream& out, const Comparison& comparison);
void print_narrow_phase_agreement(std::ostream& out, const Comparison& comparison);

}  // namespace keepout::app
