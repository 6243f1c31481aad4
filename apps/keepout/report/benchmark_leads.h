// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/benchmark_rows.h"

namespace keepout::app {

/// What to see in each section of a benchmark, in a sentence made of its figures. Plain text, not
/// yet escaped. Only ranked() rows are set against each other; of rates and stages there must be no
/// others. Precondition of all: there are rows, with the stages that the section is about.

/// `rows`: those of one radius, comparable.
std::string query_lead(const Rows& rows);

/// The same in a few words, for the caption of a panel.
std::string query_about(const Rows& rows, Stage stage);

/// `line`: one that rate_lines() gives. Its rate, and where it passes 1 kHz.
std::string rate_lead(const Rows& line);

/// What to compare all lines with.
std::string published_lead(const std::vector<Rows>& lines);

/// `rows`: those of one rule and mesh.
std::string solve_lead(const Rows& rows);

/// `rows`: those of one mesh and radius.
std::string stage_lead(const Rows& rows);

/// `rows`: one an index, on one mesh.
std::string cost_lead(const Rows& rows);

}  // namespace keepout::app
