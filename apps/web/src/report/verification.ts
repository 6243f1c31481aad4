// SPDX-License-Identifier: BSD-3-Clause
/** The sections of a campaign that tries to break the theorem, for a tip or a whole instrument. */
import { grouped, make } from "../page/elements.ts";
import { logarithmic, tipOfColumns } from "./charts.ts";
import { clearanceRows, dotAt } from "./clearance_rows.ts";
import { entries, lastKey, valueAt } from "./record.ts";
import { lead, numbersLine, panels, section } from "./report_page.ts";
import { type Inscribed, rowChart, spans } from "./row_chart.ts";
import {
  error,
  inUnit,
  mean,
  microseconds,
  percent,
  rounded,
  seconds,
  shown,
  shownMembers,
  shownWhole,
} from "./shown.ts";
import { type Column, column, harm, named, scrolled, table, tableSection } from "./table.ts";

const mesh: Column = { heading: "mesh", from: "/mesh" };

/**
 * Returns a column for each member that is not zero in some row; for `harm`, each member that must
 * be zero.
 */
const membersOf = (rows: readonly string[], key: string, kind: typeof column): Column[] =>
  entries(`${rows[0]}/${key}`)
    .map((member) => `/${key}/${lastKey(member)}`)
    .filter((from) => kind === harm || rows.some((row) => valueAt<number>(row + from) !== 0))
    .map((from) => kind(lastKey(from).replaceAll("_", " "), from));

/** Returns a length in tolerances of the certificate. */
const tolerances = inUnit("τ", (tau) => (Math.abs(tau) < 1e3 ? error(tau) : grouped(tau)));
/** The distance beyond which a shortfall is a breach. [tolerances] */
const breach = -3;

/** Plots the smallest clearance of each row, beside the promised one and the limit of a breach. */
const clearanceLeft = (
  rows: readonly string[],
  key: string,
  name: (row: string) => readonly (Inscribed | string)[],
  columns: readonly Column[],
): HTMLElement =>
  clearanceRows({
    title: "The nearest that a step came",
    description: "Smallest clearance minus the promised one, for each row, in tolerances",
    label: "clearance minus the promised one [τ]",
    rows: rows.map((from) => ({
      from,
      color: "var(--rule-certified)",
      dots: dotAt(`${from}/${key}`, (value) => value < breach),
    })),
    levels: [
      [breach, "breach"],
      [0, "promised"],
    ],
    name: ({ from }) => name(from),
    value: ({ from }) => [{ from: `${from}/${key}`, format: tolerances }],
    tip: ({ from }) => tipOfColumns([shown(`${from}/mesh`)], from, columns),
  });

/** Plots the time of the steps of each row: the median, and a line to the 99.9 %. */
function stepTimes(rows: readonly string[]): HTMLElement {
  const timed = rows.filter((row) => valueAt(`${row}/step_us/p50`));
  const at = (key: string) => (row: string) =>
    valueAt<number>(`${row}/step_us/${key}`) ?? Number.NaN;
  const [middle, last] = [at("p50"), (row: string) => at("p999")(row) || at("max")(row)];
  return rowChart({
    title: "The time of a step: median, 99.9 %",
    description: "Median time of a step and its 99.9 %, for each row",
    data: () => timed,
    name: rowName,
    value: (row) => [{ from: `${row}/step_us/p50`, format: microseconds }],
    tip: (row) => tipOfColumns([shown(`${row}/mesh`)], row, times),
    x: (all) => logarithmic("step [µs]", [...all.map(middle), ...all.map(last)]),
    marks: (seen, channels) =>
      spans(seen, { ...channels, color: () => "var(--rule-certified)" }, middle, last),
  });
}

/** Returns mesh, scenario and speed of a row. */
const rowName = (row: string): (Inscribed | string)[] => [
  { from: `${row}/mesh` },
  ", ",
  { from: `${row}/scenario` },
  ", speed ",
  { from: `${row}/speed` },
];

/** Returns the work and the results on each mesh, the shards, and each breach in full. */
export function verificationSections(): HTMLElement[] {
  const meshes = entries("/meshes");
  const total = meshes.length > 1 ? ["/total"] : [];
  const work: readonly Column[] = [
    mesh,
    column("triangles", "/triangles"),
    column("trajectories", "/trajectories"),
    column("steps", "/steps"),
    column("tips", "/tips"),
    column("steps out of the mesh", "/led_out"),
    ...membersOf(["/total"], "breaches", harm),
    column("clearance minus the promised one [mm]", "/least_beyond_margin", error),
    column("the same [τ]", "/least_beyond_margin_in_tau", error),
    column("time", "/seconds", seconds),
  ];
  const statuses = [mesh, column("steps", "/steps"), ...membersOf(["/total"], "statuses", column)];
  const shards: readonly Column[] = [
    { heading: "shard", from: "/index" },
    column("time", "/seconds", seconds),
    named("complete", "/complete"),
    { heading: "machine", from: "/machine", look: "words" },
  ];
  const breaches = entries("/breaches").length > 0;
  return [
    numbersLine(
      ["breaches", breaches ? "listed below" : "none"],
      ["steps", shown("/total/steps", grouped)],
      ["trajectories", shown("/total/trajectories", grouped)],
      ["steps out of the mesh", shown("/total/led_out", grouped)],
      [
        "least clearance minus the promised one",
        shown("/total/least_beyond_margin_in_tau", tolerances),
      ],
    ),
    section(
      "How near the steps came",
      lead(
        "The unit τ is the tolerance of the certificate, picometers to nanometers. From zero to three tolerances below the promised clearance, the difference is rounding. A step further below is a breach.",
      ),
      panels(
        clearanceLeft(
          meshes,
          "least_beyond_margin_in_tau",
          (row) => [{ from: `${row}/mesh` }],
          work.slice(1),
        ),
      ),
    ),
    section(
      "What was tried, and what broke",
      lead(
        "Each trajectory places one or more tips and moves them over the mesh. An independent judge checks each step. A step is a breach if the tip comes closer than promised, passes through the surface, or moves although the step failed.",
      ),
      scrolled(table(meshes, work, total)),
      ...(entries("/missing").length > 0
        ? [lead("Meshes that could not be had: ", ...shownWhole("/missing"), ".")]
        : []),
    ),
    section(
      "How the steps ended",
      lead(
        "The campaign also places tips inside the mesh and on its surface. The statuses inside and touching belong to such tips: they are not breaches.",
      ),
      scrolled(table(meshes, statuses, total)),
    ),
    ...(entries("/shards").length > 1
      ? [tableSection("The shards", [], entries("/shards"), shards)]
      : []),
    ...incidents("/breaches", "The first breaches, with all that it takes to do them again"),
    ...incidents("/anomalies", "What else was odd"),
  ];
}

function incidents(from: string, title: string): HTMLElement[] {
  const all = entries(from).map((incident) =>
    make("figure", {}, make("dl", {}, ...shownMembers(incident))),
  );
  return all.length > 0
    ? [section(title, make("div", { class: "panels wide", style: "--columns:1" }, ...all))]
    : [];
}

const share = (heading: string, from: string): Column =>
  column(heading, from, (value) => `${percent(value)} %`);
const time = (heading: string, key: string, of = "step_us"): Column =>
  column(heading, `/${of}/${key}`, microseconds);
const times: readonly Column[] = [
  time("median", "p50"),
  time("99 %", "p99"),
  time("99.9 %", "p999"),
  time("longest", "max"),
];

/** Returns the work and the breaches of an instrument, its steps, and their quality. */
export function robotVerificationSections(): HTMLElement[] {
  const rows = entries("/rows");
  const which = [mesh, { heading: "scenario", from: "/scenario" }, column("speed", "/speed", mean)];
  const hasTau = rows.some((row) => typeof valueAt(`${row}/least_beyond_tau`) === "number");
  return [
    section(
      "How near the steps came",
      lead(
        "The unit τ is the tolerance of the certificate. From zero to three tolerances below the promised clearance, the difference is rounding. A cycle further below is a breach.",
      ),
      panels(
        ...(hasTau ? [clearanceLeft(rows, "least_beyond_tau", rowName, times)] : []),
        stepTimes(rows),
      ),
    ),
    tableSection(
      "What was tried, and what broke",
      ["An independent judge examines fifteen poses of each cycle."],
      rows,
      [
        ...which,
        column("triangles", "/triangles"),
        column("starts", "/starts"),
        column("cycles", "/cycles"),
        harm("too close", "/below"),
        harm("in the mesh", "/in_mesh"),
        harm("limits broken", "/limits_broken"),
        column("clearance minus the promised one [mm]", "/least_beyond_mm", error),
      ],
    ),
    tableSection("The steps", ["What they took, and how they ended."], rows, [
      ...which,
      ...times,
      time("median of a ball at the tip alone", "p50", "point_us"),
      column("work units, at most", "/looks_max"),
      column("rounds", "/rounds_mean", mean),
      column("at most", "/rounds_max"),
      column("rows", "/rows_mean", mean),
      ...membersOf(rows, "statuses", column),
    ]),
    tableSection(
      "What they left",
      ["Excess: cost that a random search could still save in blocked cycles, of all there is."],
      rows,
      [
        ...which,
        share("blocked", "/blocked_share"),
        share("cut short", "/cut_share"),
        share("no motion proven", "/unmoved_share"),
        harm("worse than none", "/worse"),
        column("excess", "/excess_mean", (value) => rounded(value, 2)),
        column("searched", "/excess_samples"),
        column("useful", "/useful"),
        column("recoveries", "/recoveries"),
        column("in time", "/recovered"),
        column("cycles", "/recovery_cycles_mean", mean),
      ],
    ),
  ];
}
