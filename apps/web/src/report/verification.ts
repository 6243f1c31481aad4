// SPDX-License-Identifier: BSD-3-Clause
/** The sections of a campaign that tries to break the theorem, for a tip or a whole instrument. */
import { make } from "../page/elements.ts";
import { entries, lastKey, valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { error, mean, microseconds, percent, rounded, shownMembers, shownWhole } from "./shown.ts";
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

/** Returns the work and the results on each mesh, the shards, and each breach in full. */
export function verificationSections(): HTMLElement[] {
  const total = ["/total"];
  const work: readonly Column[] = [
    mesh,
    column("triangles", "/triangles"),
    column("trajectories", "/trajectories"),
    column("steps", "/steps"),
    column("tips", "/tips"),
    column("led out", "/led_out"),
    ...membersOf(total, "breaches", harm),
    column("least beyond margin [mm]", "/least_beyond_margin", error),
    column("the same in τ", "/least_beyond_margin_in_tau", error),
    column("time [s]", "/seconds", mean),
  ];
  const statuses = [mesh, column("steps", "/steps"), ...membersOf(total, "statuses", column)];
  const shards: readonly Column[] = [
    { heading: "shard", from: "/index" },
    column("time [s]", "/seconds", mean),
    named("complete", "/complete"),
    { heading: "machine", from: "/machine", look: "words" },
  ];
  const meshes = entries("/meshes");
  return [
    section(
      "What was tried, and what broke",
      lead(
        "Each trajectory places a tip, or several, and leads it over the mesh; each step is held to the theorem by an independent judge. Breaches ought to be none.",
      ),
      scrolled(table(meshes, work, total)),
      ...(entries("/missing").length > 0
        ? [lead("Meshes that could not be had: ", ...shownWhole("/missing"), ".")]
        : []),
    ),
    section("How the steps ended", scrolled(table(meshes, statuses, total))),
    tableSection("The shards", [], entries("/shards"), shards),
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

/** Returns the work and the breaches of an instrument, its steps, and their quality. */
export function robotVerificationSections(): HTMLElement[] {
  const rows = entries("/rows");
  const which = [mesh, { heading: "scenario", from: "/scenario" }, column("speed", "/speed", mean)];
  return [
    tableSection("What broke", ["An independent judge sees six poses of each cycle."], rows, [
      ...which,
      column("triangles", "/triangles"),
      column("starts", "/starts"),
      column("cycles", "/cycles"),
      harm("too close", "/below"),
      harm("in the mesh", "/in_mesh"),
      harm("limits broken", "/limits_broken"),
      column("least beyond what is kept [mm]", "/least_beyond_mm", error),
    ]),
    tableSection("The steps", ["What they took, and how they ended."], rows, [
      ...which,
      time("median", "p50"),
      time("99 %", "p99"),
      time("99.9 %", "p999"),
      time("longest", "max"),
      time("median of a ball at the tip alone", "p50", "point_us"),
      column("looks, at most", "/looks_max"),
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
