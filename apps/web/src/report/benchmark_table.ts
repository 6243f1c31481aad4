// SPDX-License-Identifier: BSD-3-Clause
import { grouped } from "../page/elements.ts";
import type { BenchmarkRow } from "./benchmark.ts";
import { valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { type Format, mean, percent, rounded, shown } from "./shown.ts";
import { type Column, column, named, rowFilter, scrolled, table } from "./table.ts";

/** A dash for an index without cost. */
const cost: Format = (value) => (value > 0 ? rounded(value) : "–");

const columns: readonly Column[] = [
  { heading: "index", from: "/index" },
  named("rule", "/activation"),
  named("solver", "/solver"),
  named("mesh", "/mesh"),
  column("triangles", "/triangles"),
  { heading: "radius [mm]", from: "/radius" },
  column("build [s]", "/build_s", cost),
  column("cores busy", "/build_cores", cost),
  column("bytes a triangle", "/bytes_per_triangle", cost),
  column("queries", "/queries"),
  column("candi\u00addates", "/candidates_mean", mean),
  column("hits", "/hits_mean", mean),
  column("reach any [%]", "/reaching_share", percent),
  column("planes", "/planes_mean", mean),
  column("not solved [%]", "/unsolved_share", percent),
  column("worse [%]", "/worse_share", percent),
  column("candidates only [µs]", "/collect_us/p50", rounded),
  column("exact test [µs]", "/exact_us/p50", rounded),
  column("query [µs]", "/query_us/p50", rounded),
  column("find [µs]", "/step_query_us/p50", rounded),
  column("activate [µs]", "/activate_us/p50", rounded),
  column("solve [µs]", "/solve_us/p50", rounded),
  column("step [µs]", "/step_us/p50", rounded),
  column("step 99 % [µs]", "/step_us/p99", rounded),
  column("step 99.9 % [µs]", "/step_us/p999", rounded),
  column("slowest step [µs]", "/step_us/max", rounded),
  { heading: "hash of all steps", from: "/hash" },
  { heading: "remark", from: "/remark", look: "words" },
];

const only: readonly Column[] = [column("query 99 % [µs]", "/query_us/p99", rounded)];

/** Returns columns of the table for use elsewhere, by the pointers below a row. */
export const columnsOf = (...wanted: readonly string[]): Column[] =>
  [...columns, ...only].filter(({ from }) => wanted.includes(from));

/**
 * Shows in how many groups of rows all indices made the same steps. Older records do not have the
 * counts.
 */
function sameSteps(groups: string): HTMLElement[] {
  if (!valueAt(`${groups}/groups`)) return [];
  const count = (key: string) => shown(`${groups}/${key}`, grouped);
  return [
    lead(
      "Rows that differ only in the index made the same steps, bit for bit, in ",
      count("same"),
      " of ",
      count("groups"),
      " groups. Compared were the first ",
      count("fewest_steps"),
      " to ",
      count("most_steps"),
      " steps that such rows have in common. Left out: ",
      count("single"),
      " rows without another index, ",
      count("not_verified"),
      " rows not verified.",
    ),
  ];
}

/**
 * Returns every row of a benchmark, sorted by the largest mesh, the largest sphere, and the
 * fastest.
 */
export function benchmarkTable(from: string, rows: readonly BenchmarkRow[]): HTMLElement {
  const meshes = [...new Set(rows.map(({ mesh }) => mesh))];
  const key = ({ mesh, triangles, radius, step_us }: BenchmarkRow) => [
    meshes.indexOf(mesh),
    -triangles,
    -(radius ?? 0),
    step_us?.p50 ?? Number.POSITIVE_INFINITY,
  ];
  const sorted = [...rows].sort((a, b) => {
    const [one, other] = [key(a), key(b)];
    const place = one.findIndex((value, i) => value !== other[i]);
    return place < 0 ? 0 : (one[place] as number) - (other[place] as number);
  });
  const content = table(
    sorted.map(({ from }) => from),
    columns,
  );
  const everything = section(
    "Every row",
    lead(
      "Mesh by mesh, the largest size first, then the largest sphere, then the fastest step, until another heading is pressed. Times are medians unless they say otherwise; counts are means. Rows with the same hash made the same steps, bit for bit.",
    ),
    ...sameSteps(`${from}/step_groups`),
    rowFilter(content),
    scrolled(content, "scroll windowed"),
  );
  everything.className = "everything";
  return everything;
}
