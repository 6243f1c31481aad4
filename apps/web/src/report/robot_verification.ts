// SPDX-License-Identifier: BSD-3-Clause
/** The sections of a campaign with a whole instrument. */
import { entries, valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { error, mean, microseconds, percent, rounded } from "./shown.ts";
import { type Column, column, harm, scrolled, table } from "./table.ts";

const share = (heading: string, from: string): Column =>
  column(heading, from, (value) => `${percent(value)} %`);
const time = (heading: string, key: string, of = "step_us"): Column =>
  column(heading, `/${of}/${key}`, microseconds);

const which: readonly Column[] = [
  { heading: "mesh", from: "/mesh" },
  { heading: "scenario", from: "/scenario" },
  column("speed", "/speed", mean),
];

/** What was tried and what broke, how the steps went, and how good they were. */
export function robotVerificationSections(): HTMLElement[] {
  const rows = entries("/rows");
  const statuses = entries("/rows/0/statuses")
    .map((pointer) => pointer.split("/").at(-1) ?? "")
    .filter((name) => rows.some((row) => valueAt<number>(`${row}/statuses/${name}`) !== 0));
  const safety: readonly Column[] = [
    ...which,
    column("triangles", "/triangles"),
    column("starts", "/starts"),
    column("cycles", "/cycles"),
    harm("too close", "/below"),
    harm("in the mesh", "/in_mesh"),
    harm("limits broken", "/limits_broken"),
    column("least beyond what is kept [mm]", "/least_beyond_mm", error),
  ];
  const work: readonly Column[] = [
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
    ...statuses.map((name) => column(name, `/statuses/${name}`)),
  ];
  const quality: readonly Column[] = [
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
  ];
  const part = (title: string, words: string, columns: readonly Column[]) =>
    section(title, lead(words), scrolled(table(rows, columns)));
  return [
    part("What broke", "An independent judge sees six poses of each cycle.", safety),
    part("The steps", "What they took, and how they ended.", work),
    part(
      "What they left",
      "Excess: cost that a random search could still save in blocked cycles, of all there is.",
      quality,
    ),
  ];
}
