// SPDX-License-Identifier: BSD-3-Clause

import * as three from "three";
import { make } from "../page/elements.ts";
import {
  type Anatomy,
  fitted,
  lookFrom,
  type Outlook,
  unpackedAnatomy,
  verticesOf,
} from "./anatomy.ts";
import { AnatomyView, bestDirection, hint } from "./anatomy_view.ts";
import { benchmarkSections } from "./benchmark.ts";
import { heroFigure } from "./hero.ts";
import { type Mark, mark } from "./marks.ts";
import { coloured, parted, widths } from "./paths.ts";
import { entries, lastKey, type ReportRecord, valueAt } from "./record.ts";
import { lead, method, section } from "./report_page.ts";
import { pictureGrid, runColor, runName } from "./runs.ts";
import { microseconds, millimetres, rounded, ruleName, show, shown } from "./shown.ts";
import { stepTimes } from "./simulation_charts.ts";
import { simulationDifferences, simulationNumbers } from "./simulation_findings.ts";
import { type Run, type SimulationRecord, trespass, worstCycle } from "./simulation_record.ts";
import { seen } from "./still.ts";
import { clearanceAt, distance, strokeSection } from "./stroke.ts";
import { column, harm, named, tableSection } from "./table.ts";

/** Shows the page of `simulate`. */
export async function simulationSections(main: HTMLElement, record: ReportRecord): Promise<void> {
  const simulation = record as SimulationRecord;
  const anatomy = await unpackedAnatomy(simulation.mesh);
  main.append(
    ...simulationDifferences(simulation),
    heroFigure(simulation, anatomy),
    simulationNumbers(simulation),
    hint(1),
    figures(simulation),
    strokeSection(simulation, anatomy),
    overview(simulation, anatomy),
    ...speed(simulation),
    measurement(simulation),
    ...benchmarkSections("/benchmark", "/comparison"),
  );
}

/** Returns the anatomy with all strokes, once for each run. */
function overview(record: SimulationRecord, anatomy: Anatomy): HTMLElement {
  const group = pictureGrid(record.runs.length);
  const view = new AnatomyView(group, anatomy, anatomy.corners, wholeView(record, anatomy));
  record.runs.forEach((run, number) => {
    const layer = { lengths: strokes(record, anatomy, run, number), cut: null };
    const description = `The anatomy with the paths of the tool tip, ${ruleName(run.name)}; in red where ${record.has_convex_tool ? "the tool touches the surface or is inside" : "the tip is where it must not be"}.`;
    const bad = record.has_convex_tool ? "touched" : "went in";
    const [verdict, words] = run.kept_out ? ["good", "stayed out"] : ["bad", bad];
    view.add(
      description,
      layer,
      worstPlaces(record, anatomy, run, number),
      make("span", { class: `badge ${verdict}` }, words),
      runName(number),
      make("br"),
      shown(`/runs/${number}/words`),
      ...(run.description
        ? [make("br"), show(make("span", { class: "about" }), `/runs/${number}/description`)]
        : []),
    );
  });
  return section("All strokes", group, hint(record.runs.length));
}

/** The most strokes with a ring in a picture. */
const mostRings = 6;

/**
 * Returns a ring around the worst place of each stroke in which a rule let the tool in, which makes
 * a small place visible.
 */
function worstPlaces(
  record: SimulationRecord,
  { placed }: Anatomy,
  run: Run,
  number: number,
): Mark[] {
  if (run.kept_out || run.rule === "none") return [];
  const failed = [...run.strokes.keys()].filter((stroke) =>
    trespass(run, stroke, record).includes(true),
  );
  const [worst] = [run.worst.stroke];
  const strokes = [worst, ...failed.filter((stroke) => stroke !== worst)].slice(0, mostRings);
  return strokes.flatMap((stroke) => {
    const cycle = stroke === worst ? run.worst.cycle : worstCycle(run, stroke);
    const place = run.strokes[stroke]?.tip[cycle];
    const label = distance(record, clearanceAt(number, stroke, cycle), true);
    return place ? [mark("ring bad", placed(place), 15, label)] : [];
  });
}

function strokes(record: SimulationRecord, anatomy: Anatomy, run: Run, number: number) {
  const parts = run.strokes.map(({ tip }, stroke) => {
    const isBad = trespass(run, stroke, record);
    return parted(tip.map(anatomy.placed), isBad, 1e-3 * anatomy.size);
  });
  // Many strokes that stayed out would hide those that did not.
  const isFailed = ({ bad }: (typeof parts)[number]) => bad.length > 0;
  const pale =
    run.rule !== "none" && parts.length > 24 ? parts.filter((one) => !isFailed(one)) : [];
  const full = parts.filter((one) => !pale.includes(one));
  const goodOf = (some: typeof parts) => some.flatMap(({ good }) => good);
  const color = runColor(number);
  const faint = coloured(goodOf(pale), [], color, widths.faint).slice(0, 1);
  return [
    ...faint.map((lengths) => ({ ...lengths, opacity: 0.25 })),
    ...coloured(
      goodOf(full),
      full.flatMap(({ bad }) => bad),
      color,
      widths.whole,
    ),
  ];
}

/** Upright, from a direction that shows most of the strokes of the last run. */
function wholeView(record: SimulationRecord, anatomy: Anatomy): Outlook {
  const every = 10;
  const some = (run: Run) =>
    run.strokes.flatMap(({ tip }) => tip.filter((_, i) => i % every === 0).map(anatomy.placed));
  const up = new three.Vector3(...record.up).normalize();
  const all = [...record.runs.flatMap(some), ...verticesOf(anatomy)];
  const outlook = (toward: three.Vector3) => {
    const { middle, height } = fitted(all, toward, up);
    // Space for the scale bar below.
    middle.addScaledVector(up, -0.035 * height);
    return lookFrom(toward, up, middle, 1.13 * height, anatomy.size);
  };
  const tips = record.runs.slice(-1).flatMap(some);
  const trial = [148, 111] as const;
  return outlook(
    bestDirection(directions(up), (toward) => {
      const { camera } = outlook(toward);
      const { depths } = seen(anatomy, anatomy.corners, camera, trial);
      const slack = (0.01 * anatomy.size) / (camera.far - camera.near);
      return tips.filter((tip) => {
        const { x, y, z } = tip.clone().project(camera);
        const [column, row] = [((x + 1) * trial[0]) / 2, ((1 - y) * trial[1]) / 2];
        const depth = depths[Math.floor(row) * trial[0] + Math.floor(column)] ?? 1;
        return z - 2 * slack <= depth;
      }).length;
    }),
  );
}

/** Returns directions all around, level and slightly from above. */
function directions(up: three.Vector3): three.Vector3[] {
  const east = new three.Vector3(up.y, up.z, up.x).cross(up).normalize();
  return [0.1, 0.45].flatMap((elevation) =>
    Array.from({ length: 12 }, (_, k) =>
      east
        .clone()
        .applyAxisAngle(up, (Math.PI * k) / 6)
        .multiplyScalar(Math.cos(elevation))
        .addScaledVector(up, Math.sin(elevation)),
    ),
  );
}

const figures = ({ has_convex_tool, guides }: SimulationRecord): HTMLElement =>
  tableSection(
    "The figures",
    [
      has_convex_tool
        ? "A contact is a cycle in which the tool touched or cut the surface. The closest approach is that of the whole tool. "
        : "A crossing is a move after which, or during which, the tip was on the other side of the surface. ",
      ...(guides?.length
        ? [
            "A guide is left in a cycle if the tip is farther outside its region than the guide allows; how far outside is that of the whole run. ",
          ]
        : []),
      "The rate is how often the median step fits into a millisecond.",
    ],
    entries("/runs"),
    [
      { ...named("rule", "/name"), content: (row) => [runName(Number(lastKey(row)))] },
      // A convex tool and an open surface have no depth.
      ...(valueAt("/runs/0/summary/deepest_mm") === null
        ? []
        : [
            harm("deepest inside", "/summary/deepest_mm", millimetres),
            harm("cycles inside", "/summary/cycles_inside"),
          ]),
      harm(has_convex_tool ? "contacts" : "crossings", "/summary/crossings"),
      ...(guides?.length
        ? [
            harm("guides left", "/summary/guides_left"),
            column("farthest outside a guide", "/summary/farthest_out_mm", millimetres),
          ]
        : []),
      column("closest approach", "/summary/closest_approach_mm", millimetres),
      column("cycles", "/summary/cycles"),
      column("cycles limited", "/summary/limited"),
      column("cycles stopped", "/summary/stopped"),
      column("rate [kHz]", "/summary/rate_khz", rounded),
      column("median step", "/summary/p50_us", microseconds),
      column("99 %", "/summary/p99_us", microseconds),
      column("99.9 %", "/summary/p999_us", microseconds),
      column("slowest", "/summary/max_us", microseconds),
    ],
  );

function speed(record: SimulationRecord): HTMLElement[] {
  const times = stepTimes(record);
  if (times.length === 0) return [];
  return [
    section(
      "How fast it was",
      lead("Read the plot at 1 %: one step in a hundred took this long or longer."),
      ...times,
    ),
  ];
}

/** Explains how the audit knows where the tip, or a convex tool, is. */
function judgement({ mesh, has_convex_tool }: SimulationRecord): string {
  if (has_convex_tool) {
    return "The clearance of the whole tool is the distance of its convex hull from the triangles, by a computation that shares nothing with the rule. A tool that touches the surface or is inside is at least as deep as the number says. A motion counts as a contact unless the distances on its way prove that the tool did not touch; a distance up to 1 nm counts as touching.";
  }
  return mesh.surface === "closed"
    ? "Inside or outside is told by counting how often a ray from the tip passes through the surface, which shares nothing with the rules."
    : "The surface has holes, so it has no inside: only crossings count. On which side of the surface the tip is, is told by the angle-weighted normal at the nearest point of it (the pseudonormal), which no rule uses. The tip may go around a rim; sliding around one in contact counts as a crossing.";
}

/** Explains the source of the distances of a tip. */
const distances =
  " Distances come from a search tree (a PD-tree) and a closest-point computation that the rules may use too. The tests compare both with brute force and with an independent computation in quadruple precision. A depth up to 1 nm counts as touching, not as inside.";

function measurement(record: SimulationRecord): HTMLElement {
  return section(
    "How this was measured",
    method(
      "A simulated operator moves over the anatomy and pushes into it; its random motions are seeded. Every rule gets the same commanded motions, and may shorten or turn each before the tool follows. After every cycle an independent check finds where the tool really is. ",
      judgement(record),
      ...(record.has_convex_tool ? [] : [distances]),
    ),
    method(
      "Times are of the step alone, on the machine named below, with whatever else that machine did meanwhile.",
    ),
  );
}
