// SPDX-License-Identifier: BSD-3-Clause

import * as three from "three";
import { grouped, make } from "../page/elements.ts";
import { type Anatomy, fitted, lookFrom, unpackedAnatomy } from "./anatomy.ts";
import { AnatomyView, hint } from "./anatomy_view.ts";
import { coloured, ends, widths } from "./paths.ts";
import { type ReportRecord, valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { pictureGrid, runColor } from "./runs.ts";
import { rounded, shown } from "./shown.ts";
import type { PlanRecord } from "./simulation_record.ts";
import { type Column, column, harm, named, scrolled, table } from "./table.ts";

/** What the page of `plan` shows. */
export async function planningSections(main: HTMLElement, record: ReportRecord): Promise<void> {
  const plan = record as PlanRecord;
  for (const mesh of plan.meshes.keys()) main.append(await meshSection(plan, mesh));
}

const columns: readonly Column[] = [
  named("checker", "/checker"),
  column("runs", "/runs"),
  column("solved", "/solved"),
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
  column("median [s]", "/median_seconds", rounded),
  column("checking [s]", "/median_checking_seconds", rounded),
  column("motions asked", "/median_checks"),
  column("length [mm]", "/median_length_mm", rounded),
];

/** One mesh: what came out under each checker, and all paths that were found. */
async function meshSection(plan: PlanRecord, number: number): Promise<HTMLElement> {
  const mesh = plan.meshes[number] as PlanRecord["meshes"][number];
  const anatomy = await unpackedAnatomy(mesh);
  const rows = [...plan.summaries.keys()].filter((row) => plan.summaries[row]?.mesh === mesh.name);
  const group = pictureGrid(2);
  const view = new AnatomyView(group, anatomy, anatomy.corners, outlook(anatomy));
  rows.forEach((row, place) => {
    const checker = plan.summaries[row]?.checker as string;
    const runs = plan.runs.filter((run) => run.mesh === mesh.name && run.checker === checker);
    const good = runs.flatMap(({ path }) => ends((path ?? []).map(anatomy.placed)));
    const tooNear = runs.flatMap(({ too_near }) => too_near ?? []);
    const bad = tooNear.flatMap((length) => ends(length.map(anatomy.placed)));
    const lengths = coloured(good, bad, runColor(place + 1), widths.many, mesh.inside);
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
  return section(
    shown(`/meshes/${number}/name`),
    lead(
      "All paths found under each checker. ",
      make("b", {}, "Red"),
      ": nearer to the mesh than allowed, or through it. A path is valid if all of it keeps the clearance. The sliding checker has a planner of its own, SlidingConnect.",
    ),
    scrolled(
      table(
        rows.map((row) => `/summaries/${row}`),
        columns,
      ),
    ),
    group,
    hint(),
  );
}

/** From the side and a little above, z upwards, as the fixtures stand. */
function outlook(anatomy: Anatomy) {
  const [toward, up] = [new three.Vector3(0.9, -0.5, 0.35), new three.Vector3(0, 0, 1)];
  const places = Array.from({ length: anatomy.positions.length / 3 }, (_, i) =>
    new three.Vector3().fromArray(anatomy.positions, 3 * i),
  );
  const { middle, height } = fitted(places, toward, up);
  return lookFrom(toward, up, middle, 1.13 * height, anatomy.size);
}
