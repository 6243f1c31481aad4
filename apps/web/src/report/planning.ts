// SPDX-License-Identifier: BSD-3-Clause

import * as three from "three";
import { grouped, make } from "../page/elements.ts";
import { lookAtAll, unpackedAnatomy, verticesOf } from "./anatomy.ts";
import { AnatomyView, hint } from "./anatomy_view.ts";
import { tipOfColumns } from "./charts.ts";
import { clearanceRows, dotAt } from "./clearance_rows.ts";
import { coloured, ends, widths } from "./paths.ts";
import { entries, type ReportRecord, valueAt } from "./record.ts";
import { differences, lead, panels, section } from "./report_page.ts";
import { pictureGrid, ruleColor, swatched } from "./runs.ts";
import { listed, rounded, seconds, shown } from "./shown.ts";
import type { PlanRecord } from "./simulation_record.ts";
import { type Column, column, harm, named, scrolled, table, tableSection } from "./table.ts";

/** Shows the page of `plan`. */
export async function planningSections(main: HTMLElement, record: ReportRecord): Promise<void> {
  const plan = record as PlanRecord;
  const first = entries("/summaries").filter(
    (row) => valueAt(`${row}/mesh`) === plan.meshes[0]?.name,
  );
  main.append(...differences(times(first)));
  for (const mesh of plan.meshes.keys()) main.append(await meshSection(plan, mesh));
}

const isCertified = (row: string): boolean => valueAt(`${row}/checker`) === "certified";

/** Returns the checker by samples with the most invalid paths, and the certified checker. */
function telling(rows: readonly string[]): string[] {
  const invalid = (row: string) =>
    Number(valueAt(`${row}/solved`)) - Number(valueAt(`${row}/valid`));
  const others = rows.filter((row) => !isCertified(row));
  others.sort((a, b) => invalid(b) - invalid(a));
  return [...others.slice(0, 1), ...rows.filter(isCertified)];
}

/** Returns a sentence on the time of a search with the certified checker, and with the other one that accepted most invalid paths. */
const times = (rows: readonly string[]): (Node | string)[] => {
  const parts = telling(rows).map((row) => [
    shown(`${row}/median_seconds`, seconds),
    " with ",
    shown(`${row}/checker`),
  ]);
  return parts.length > 0
    ? ["The median search in ", shown(`${rows[0]}/mesh`), " took ", ...listed(parts), "."]
    : [];
};

/** Plots the least clearance of each path, with a row for each checker. */
function leastClearances(rows: readonly string[], required: string): HTMLElement[] {
  const runs = entries("/runs");
  const of = (run: string, key: string) => valueAt(`${run}/${key}`);
  const isValid = (run: string) => of(run, "valid") ?? of(run, "too_close") === 0;
  const several = new Set(rows.map((row) => valueAt(`${row}/mesh`))).size > 1;
  const dotted = rows.map((from) => ({
    from,
    color: `var(${ruleColor(String(valueAt(`${from}/checker`)))})`,
    dots: runs
      .filter((run) => ["mesh", "checker"].every((key) => of(run, key) === of(from, key)))
      .flatMap((run) => dotAt(`${run}/clearance_mm`, () => !isValid(run))),
  }));
  if (dotted.every(({ dots }) => dots.length === 0)) return [];
  const plot = clearanceRows({
    title: "The nearest place of each path",
    description: "Least clearance of each path that was found, for each checker",
    label: "clearance [mm]",
    rows: dotted,
    levels: [[Number(valueAt(required)), "required clearance"]],
    name: ({ from }) => [
      ...(several ? [{ from: `${from}/mesh` }, ", "] : []),
      { from: `${from}/checker` },
    ],
    value: ({ from }) => [{ from: `${from}/valid` }, " of ", { from: `${from}/solved` }, " valid"],
    tip: ({ from }) => tipOfColumns([shown(`${from}/checker`)], from, cost),
  });
  return [panels(plot)];
}

/** The results under a checker: the runs that have a path. */
const solved: readonly Column[] = [
  named("checker", "/checker"),
  column("runs", "/runs"),
  column("solved", "/solved"),
];
/** The cost of its paths. */
const cost: readonly Column[] = [
  column("median time", "/median_seconds", seconds),
  column("of it checking", "/median_checking_seconds", seconds),
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
  const rows = entries("/summaries").filter((row) => valueAt(`${row}/mesh`) === mesh.name);
  const drawnRows = telling(rows);
  const group = pictureGrid(drawnRows.length);
  // From the side and slightly above, with z upward, as the sample meshes are oriented.
  const [toward, up] = [new three.Vector3(0.9, -0.5, 0.35), new three.Vector3(0, 0, 1)];
  const places = plan.runs
    .filter((run) => run.mesh === mesh.name)
    .flatMap(({ path }) => (path ?? []).map(anatomy.placed));
  const outlook = lookAtAll([...verticesOf(anatomy), ...places], toward, up, anatomy);
  const view = new AnatomyView(group, anatomy, anatomy.corners, outlook);
  for (const from of drawnRows) {
    const checker = valueAt<string>(`${from}/checker`) as string;
    const runs = plan.runs.filter((run) => run.mesh === mesh.name && run.checker === checker);
    const good = runs.flatMap(({ path }) => ends((path ?? []).map(anatomy.placed)));
    const tooNear = runs.flatMap(({ too_near }) => too_near ?? []);
    const bad = tooNear.flatMap((length) => ends(length.map(anatomy.placed)));
    const color = ruleColor(checker);
    const hidden = mesh.inside ? [] : coloured(good, [], color, widths.many, true);
    const lengths = [
      ...coloured(good, bad, color, widths.whole, mesh.inside),
      ...hidden.map((length) => ({ ...length, opacity: 0.3 })),
    ];
    view.add(
      `All paths found under the checker ${checker}.`,
      { lengths, cut: null },
      [],
      swatched(ruleColor(checker), shown(`${from}/checker`)),
      make("br"),
      shown(`${from}/solved`, grouped),
      " solved, of these ",
      shown(`${from}/valid`, grouped),
      " valid",
    );
  }
  return section(
    shown(`/meshes/${number}/name`),
    lead(
      "All paths that two of the checkers found. ",
      make("b", {}, "Red"),
      ": nearer to the mesh than allowed, or through it. Pale: hidden by the surface. A path is valid if all of it keeps the clearance. The sliding checker has a planner of its own, SlidingConnect.",
    ),
    group,
    hint(drawnRows.length),
    ...leastClearances(rows, "/clearance_mm"),
    scrolled(table(rows, columns)),
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
  const rows = entries("/summaries");
  const first = rows.filter((row) => valueAt(`${row}/mesh`) === valueAt(`${rows[0]}/mesh`));
  return [
    ...differences(times(first)),
    ...leastClearances(rows, "/margin_mm"),
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
        column("time", "/seconds", seconds),
        column("motions asked", "/checks"),
        ...judged,
        column("least clearance [mm]", "/clearance_mm", (mm) => rounded(mm, 4)),
        column("length [mm]", "/length_mm", rounded),
      ],
    ),
  ];
}
