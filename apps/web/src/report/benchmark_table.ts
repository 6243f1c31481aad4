// SPDX-License-Identifier: BSD-3-Clause
import type { BenchmarkRow } from "./benchmark.ts";
import { valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { type Format, grouped, mean, percent, rounded, show } from "./shown.ts";
import { type Column, rowFilter, scrolled, table } from "./table.ts";

/** Nothing for what an index of no cost has. */
const cost: Format = (value) => (value > 0 ? rounded(value) : "–");

const columns: readonly Column[] = [
  { heading: "index", from: "/index" },
  { heading: "rule", from: "/activation", look: "name" },
  { heading: "solver", from: "/solver", look: "name" },
  { heading: "mesh", from: "/mesh", look: "name" },
  { heading: "triangles", from: "/triangles", format: grouped },
  { heading: "radius [mm]", from: "/radius" },
  { heading: "build [s]", from: "/build_s", format: cost },
  { heading: "cores busy", from: "/build_cores", format: cost },
  { heading: "bytes a triangle", from: "/bytes_per_triangle", format: cost },
  { heading: "queries", from: "/queries", format: grouped },
  { heading: "candi\u00addates", from: "/candidates_mean", format: mean },
  { heading: "hits", from: "/hits_mean", format: mean },
  { heading: "reach any [%]", from: "/reaching_share", format: percent },
  { heading: "planes", from: "/planes_mean", format: mean },
  { heading: "not solved [%]", from: "/unsolved_share", format: percent },
  { heading: "worse [%]", from: "/worse_share", format: percent },
  { heading: "candidates only [µs]", from: "/collect_us/p50", format: rounded },
  { heading: "query [µs]", from: "/query_us/p50", format: rounded },
  { heading: "find [µs]", from: "/step_query_us/p50", format: rounded },
  { heading: "activate [µs]", from: "/activate_us/p50", format: rounded },
  { heading: "solve [µs]", from: "/solve_us/p50", format: rounded },
  { heading: "step [µs]", from: "/step_us/p50", format: rounded },
  { heading: "step 99 % [µs]", from: "/step_us/p99", format: rounded },
  { heading: "step 99.9 % [µs]", from: "/step_us/p999", format: rounded },
  { heading: "slowest step [µs]", from: "/step_us/max", format: rounded },
  { heading: "hash of all steps", from: "/hash" },
  { heading: "remark", from: "/remark", look: "words" },
];

const only: readonly Column[] = [
  { heading: "query 99 % [µs]", from: "/query_us/p99", format: rounded },
];

/** What is told of a row elsewhere as the table tells it, by where below a row it is. */
export const columnsOf = (...wanted: readonly string[]): Column[] =>
  [...columns, ...only].filter(({ from }) => wanted.includes(from));

/** Every row of a benchmark, the largest mesh first, then the largest sphere, then the fastest. */
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
    ...(valueAt(`${from}/same_steps`) ? [show(lead(), `${from}/same_steps`)] : []),
    rowFilter(content),
    scrolled(content, "scroll windowed"),
  );
  everything.className = "everything";
  return everything;
}
