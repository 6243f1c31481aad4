// SPDX-License-Identifier: BSD-3-Clause

import * as three from "three";
import { grouped, make } from "../page/elements.ts";
import { lookAtAll, unpackedAnatomy, verticesOf } from "./anatomy.ts";
import { AnatomyView, hint } from "./anatomy_view.ts";
import { coloured, ends, widths } from "./paths.ts";
import { entries, type ReportRecord, valueAt } from "./record.ts";
import { pictureGrid, ruleColor } from "./runs.ts";
import { rounded, shown } from "./shown.ts";
import type { PlanRecord } from "./simulation_record.ts";
import { type Column, column, harm, named, tableSection } from "./table.ts";

/** Shows the page of `plan`. */
export async function planningSections(main: HTMLElement, record: ReportRecord): Promise<void> {
  const plan = record as PlanRecord;
  for (const mesh of plan.meshes.keys()) main.append(await meshSection(plan, mesh));
}

/** The results under a checker: the runs that have a path. */
const solved: readonly Column[] = [
  named("checker", "/checker"),
  column("runs", "/runs"),
  column("solved", "/solved"),
];
/** The cost of its paths. */
const cost: readonly Column[] = [
  column("median [s]", "/median_seconds", rounded),
  column("checking [s]", "/median_checking_seconds", rounded),
  column("motions asked", "/median_checks"),
  column("length [mm]", "/median_length_mm", rounded),
];
const columns: readonly Column[] = [
  ...solved,
  {
    heading: "valid",
    from: "/valid",
    content: (row) => {
      const isLess = Number(valueAt(`${row}/valid`)) < Number(valueAt(`${row}/solved`));
      return [make("span", isLess ? { class: "bad" } : {}, shown(`${row}/valid`, grouped))];
    },
  },
  harm("enters", "/entering"),
  column("least clearance [mm]", "/least_clearance_mm", (mm) => rounded(mm, 4)),
  ...cost,
];

/** Returns the section of a mesh: the results under each checker, and all paths. */
async function meshSection(plan: PlanRecord, number: number): Promise<HTMLElement> {
  const mesh = plan.meshes[number] as PlanRecord["meshes"][number];
  const anatomy = await unpackedAnatomy(mesh);
  const rows = [...plan.summaries.keys()].filter((row) => plan.summaries[row]?.mesh === mesh.name);
  const group = pictureGrid(2);
  // From the side and slightly above, with z upward, as the sample meshes are oriented.
  const [toward, up] = [new three.Vector3(0.9, -0.5, 0.35), new three.Vector3(0, 0, 1)];
  const outlook = lookAtAll(verticesOf(anatomy), toward, up, anatomy);
  const view = new AnatomyView(group, anatomy, anatomy.corners, outlook);
  rows.forEach((row) => {
    const checker = plan.summaries[row]?.checker as string;
    const runs = plan.runs.filter((run) => run.mesh === mesh.name && run.checker === checker);
    const good = runs.flatMap(({ path }) => ends((path ?? []).map(anatomy.placed)));
    const tooNear = runs.flatMap(({ too_near }) => too_near ?? []);
    const bad = tooNear.flatMap((length) => ends(length.map(anatomy.placed)));
    const lengths = coloured(good, bad, ruleColor(checker), widths.many, mesh.inside);
    const from = `/summaries/${row}`;
    view.add(
      `All paths found under the checker ${checker}.`,
      { lengths, cut: null },
      [],
      make("span", { class: "name" }, shown(`${from}/checker`)),
      make("br"),
      shown(`${from}/solved`, grouped),
      " solved, of these ",
      shown(`${from}/valid`, grouped),
      " valid",
    );
  });
  return tableSection(
    shown(`/meshes/${number}/name`),
    [
      "All paths found under each checker. ",
      make("b", {}, "Red"),
      ": nearer to the mesh than allowed, or through it. A path is valid if all of it keeps the clearance. The sliding checker has a planner of its own, SlidingConnect.",
    ],
    rows.map((row) => `/summaries/${row}`),
    columns,
    group,
    hint(rows.length),
  );
}

/** Returns the results under each checker for a whole instrument, and of each run. */
export function robotPlanningSections(): HTMLElement[] {
  const mesh: Column = { heading: "mesh", from: "/mesh" };
  const judged: readonly Column[] = [
    column("motions", "/motions"),
    harm("too close", "/too_close"),
    harm("in the mesh", "/entering"),
    harm("unproven", "/unproven"),
  ];
  return [
    tableSection(
      "Under each checker",
      [
        "Motions are those between neighbors on the paths that were found. The oracle examines them every 0.05 mm. Unproven are those that keepout does not prove in pieces of 1 mm. A path is valid if no motion is too close.",
      ],
      entries("/summaries"),
      [
        mesh,
        ...solved,
        column("valid", "/valid"),
        ...judged,
        column("deepest [mm]", "/deepest_mm", rounded),
        ...cost,
      ],
    ),
    tableSection(
      "The runs",
      ["What is empty was not solved. No clearance: it never came as near as the margin."],
      entries("/runs"),
      [
        mesh,
        named("checker", "/checker"),
        column("problem", "/problem"),
        column("seed", "/seed"),
        column("time [s]", "/seconds", rounded),
        column("motions asked", "/checks"),
        ...judged,
        column("least clearance [mm]", "/clearance_mm", (mm) => rounded(mm, 4)),
        column("length [mm]", "/length_mm", rounded),
      ],
    ),
  ];
}
