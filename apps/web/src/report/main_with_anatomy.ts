// SPDX-License-Identifier: BSD-3-Clause
/** The reports that show anatomy. */
import { inspectionSections } from "./inspection.ts";
import { planningSections } from "./planning.ts";
import { showReport } from "./report_page.ts";
import { robotSimulationSections } from "./robot_simulation.ts";
import { simulationSections } from "./simulation.ts";

void showReport({
  simulate: simulationSections,
  simulate_robot: robotSimulationSections,
  plan: planningSections,
  inspect: inspectionSections,
});
