// SPDX-License-Identifier: BSD-3-Clause
/** The reports that show no anatomy. */
import { benchmarkSections } from "./benchmark.ts";
import { comparisonSections } from "./comparison.ts";
import { experimentSections } from "./experiments.ts";
import { robotPlanningSections } from "./planning.ts";
import { showReport } from "./report_page.ts";
import { speedSections } from "./speed.ts";
import { robotVerificationSections, verificationSections } from "./verification.ts";

void showReport({
  bench: (main) => main.append(...benchmarkSections("/benchmark", "/comparison")),
  speed: (main) => main.append(...speedSections()),
  compare: (main) => main.append(...comparisonSections("/comparison")),
  plan_robot: (main) => main.append(...robotPlanningSections()),
  verify: (main) => main.append(...verificationSections()),
  experiments: (main) => main.append(...experimentSections()),
  verify_robot: (main) => main.append(...robotVerificationSections()),
});
