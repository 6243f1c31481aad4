// SPDX-License-Identifier: BSD-3-Clause
/** The reports that show anatomy. */
import { planningSections } from "./planning.ts";
import { showReport } from "./report_page.ts";
import { simulationSections } from "./simulation.ts";

void showReport({ simulate: simulationSections, plan: planningSections });
