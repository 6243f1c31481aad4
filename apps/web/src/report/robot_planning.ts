// SPDX-License-Identifier: BSD-3-Clause
/** The sections of plans for a whole instrument. */
import { entries } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { rounded } from "./shown.ts";
import { type Column, column, harm, named, scrolled, table } from "./table.ts";

const which: readonly Column[] = [{ heading: "mesh", from: "/mesh" }, named("checker", "/checker")];
/** What is told of one path, and added up of many. */
const judged: readonly Column[] = [
  column("motions", "/motions"),
  harm("too close", "/too_close"),
  harm("in the mesh", "/entering"),
  harm("unproven", "/unproven"),
];

/** What came out under each checker, and of each run. */
export function robotPlanningSections(): HTMLElement[] {
  const summaries: readonly Column[] = [
    ...which,
    column("runs", "/runs"),
    column("solved", "/solved"),
    column("valid", "/valid"),
    ...judged,
    column("deepest [mm]", "/deepest_mm", rounded),
    column("median [s]", "/median_seconds", rounded),
    column("checking [s]", "/median_checking_seconds", rounded),
    column("motions asked", "/median_checks"),
    column("length [mm]", "/median_length_mm", rounded),
  ];
  const runs: readonly Column[] = [
    ...which,
    column("problem", "/problem"),
    column("seed", "/seed"),
    column("time [s]", "/seconds", rounded),
    column("motions asked", "/checks"),
    ...judged,
    column("least clearance [mm]", "/clearance_mm", (mm) => rounded(mm, 4)),
    column("length [mm]", "/length_mm", rounded),
  ];
  return [
    section(
      "Under each checker",
      lead(
        "Motions are those between neighbors on the paths that were found. The oracle examines them every 0.05 mm. Unproven are those that keepout does not prove in pieces of 1 mm. A path is valid if no motion is too close.",
      ),
      scrolled(table(entries("/summaries"), summaries)),
    ),
    section(
      "The runs",
      lead("What is empty was not solved. No clearance: it never came as near as the margin."),
      scrolled(table(entries("/runs"), runs)),
    ),
  ];
}
