// SPDX-License-Identifier: BSD-3-Clause
/**
 * The sections of a comparison: whether indices, solvers and narrow phases give the same answers.
 */

import { grouped, make } from "../page/elements.ts";
import { Legend, logarithmic, looksOf, tipOfColumns } from "./charts.ts";
import { entries, valueAt } from "./record.ts";
import { differences, lead, panels, section } from "./report_page.ts";
import { rowChart, spans } from "./row_chart.ts";
import { error, listed, microseconds, rounded, shown, shownName } from "./shown.ts";
import { type Column, column, harm, isHarmed, named, scrolled, table } from "./table.ts";

const size = (heading: string, from: string): Column => column(heading, from, error);
const times: readonly Column[] = [
  column("median [µs]", "/p50_us", rounded),
  column("99 % [µs]", "/p99_us", rounded),
];

const indexColumns: readonly Column[] = [
  named("index", "/index"),
  named("rule", "/activation"),
  named("mesh", "/mesh"),
  named("searched by the rule", "/searched_by_the_rule"),
  column("poses", "/poses"),
  harm("missed", "/missed"),
  harm("invented", "/invented"),
  size("worst error of a closest point [mm]", "/closest_point_error_mm"),
  size("worst angle of a plane [rad]", "/plane_angle_rad"),
  size("worst difference of a step [mm]", "/step_difference_mm"),
  harm("steps that differ", "/steps_that_differ"),
];
const solverColumns: readonly Column[] = [
  named("solver", "/solver"),
  named("rule", "/activation"),
  column("recorded", "/posed"),
  column("problems", "/problems"),
  column("optimal", "/optimal"),
  column("infeasible", "/infeasible"),
  harm("gave up", "/gave_up"),
  harm("wrong", "/wrong"),
  size("worst difference of a step, relative", "/step_difference"),
  size("worst KKT residual", "/kkt_residual"),
  ...times,
];
const narrowPhaseColumns: readonly Column[] = [
  named("narrow phase", "/backend"),
  named("tool", "/tool"),
  named("relation", "/relation"),
  column("pairs", "/pairs"),
  harm("no answer", "/failed"),
  {
    ...harm("contradicted", "/contradicted"),
    isExpected: (row) => valueAt(`${row}/relation`) === "touching",
  },
  size("median error [mm]", "/median_error_mm"),
  size("worst error [mm]", "/worst_error_mm"),
  ...times,
];

/** Returns one sentence for each column of harm, which names the parts with harm, such as "Invented: pd_tree. " */
const faults = (rows: readonly string[], columns: readonly Column[]): (Node | string)[] =>
  columns
    .filter(({ look }) => look === "harm")
    .flatMap((column) => {
      const { heading } = column;
      const name = columns[0]?.from;
      const guilty = rows.filter((row) => isHarmed(row, column));
      const names = new Map(guilty.map((row) => [valueAt(row + name), row + name]));
      const all = [...names.values()].flatMap((at, i) => [i > 0 ? ", " : "", shown(at)]);
      const words = heading.charAt(0).toUpperCase() + heading.slice(1);
      return [`${words}: `, ...(all.length > 0 ? all : ["none"]), ". "];
    });

/** `from`: the pointer to the comparison. Parts that were not compared are omitted. */
export function comparisonSections(from: string): HTMLElement[] {
  const part = (
    key: string,
    title: string,
    columns: readonly Column[],
    note: string,
    more: (rows: readonly string[]) => readonly HTMLElement[] = () => [],
  ) => {
    const rows = entries(`${from}/${key}/rows`);
    if (rows.length === 0) return [];
    const words = lead(...faults(rows, columns), note);
    const all = scrolled(table(rows, columns), rows.length > 12 ? "scroll windowed" : "scroll");
    return [section(title, words, ...more(rows), all)];
  };
  if (!valueAt(from)) return [];
  const extent = valueAt(`${from}/complete`) ? "" : "It was stopped: some rows are missing. ";
  const finding = valueAt(`${from}/agree`)
    ? ""
    : "An index differs, or a solver is wrong: please report it.";
  return [
    ...differences(
      extent + finding === "" ? [] : [extent, finding],
      mostContradicted(from),
      slowestSolver(from),
    ),
    ...part(
      "narrow_phases",
      "Do the narrow phases agree?",
      narrowPhaseColumns,
      "Distances are held to the exact kernel. A narrow phase contradicts it if it calls an overlap what is apart, or the reverse. Pairs that touch within 0.000001 mm are finer than the tolerance of most libraries: there a contradiction is expected, and is neither named here nor red in the table.",
      errors,
    ),
    ...part(
      "solvers",
      "Do the solvers agree?",
      solverColumns,
      "Every answer to a recorded problem is checked. Slow solvers get fewer of the problems, evenly spread.",
      outcomes,
    ),
    ...part(
      "indices",
      "Do the indices agree?",
      indexColumns,
      "Held to brute force on the same poses. The exact kernel decides whichever index proposes: only a triangle missed or given twice can change a step, unless the rule searches the index itself.",
    ),
  ];
}

/** Returns the row with the largest value of a column; undefined if no value is above zero. */
function largest(rows: readonly string[], key: string): string | undefined {
  const value = (row: string) => Number(valueAt(`${row}/${key}`));
  const [first] = [...rows].sort((a, b) => value(b) - value(a));
  return first !== undefined && value(first) > 0 ? first : undefined;
}

/** Returns a sentence on the narrow phase that contradicts the exact kernel most often. */
function mostContradicted(from: string): (Node | string)[] {
  const row = largest(entries(`${from}/narrow_phases/rows`), "contradicted");
  if (row === undefined) return [];
  const count = (key: string) => shown(`${row}/${key}`, grouped);
  return [
    "The narrow phases differ: ",
    shown(`${row}/backend`),
    " contradicts the exact kernel in ",
    count("contradicted"),
    " of ",
    count("pairs"),
    " pairs that are ",
    shown(`${row}/relation`),
    ".",
  ];
}

/** Returns a sentence on the median times of the fastest and of the slowest solver. */
function slowestSolver(from: string): (Node | string)[] {
  const rows = entries(`${from}/solvers/rows`).filter((row) => valueAt(`${row}/p50_us`) !== null);
  const slow = largest(rows, "p50_us");
  if (slow === undefined || rows.length < 2) return [];
  const time = (row: string) => Number(valueAt(`${row}/p50_us`));
  const fast = [...rows].sort((a, b) => time(a) - time(b))[0] as string;
  const parts = [fast, slow].map((row) => [
    shown(`${row}/p50_us`, microseconds),
    " with ",
    shown(`${row}/solver`),
  ]);
  return ["The median problem took ", ...listed(parts), "."];
}

/** Returns the statuses of the libraries, in their own words, with a line for each solver. */
function outcomes(rows: readonly string[]): HTMLElement[] {
  const lines = rows.flatMap((row) => {
    const most = entries(`${row}/outcomes`).sort(
      (a, b) => (valueAt<number>(b) ?? 0) - (valueAt<number>(a) ?? 0),
    );
    const said = most.flatMap((outcome, i) => [
      i > 0 ? "; " : "",
      shown(outcome, grouped),
      "\u00a0× ",
      shownName(outcome),
    ]);
    const solver = [shown(`${row}/solver`), ", ", shown(`${row}/activation`)];
    return said.length > 0 ? [make("dt", {}, ...solver), make("dd", {}, ...said)] : [];
  });
  return [
    make("h3", {}, "What the libraries said, and what was found"),
    make("figure", {}, make("dl", { class: "long" }, ...lines)),
  ];
}

interface NarrowPhaseRow {
  readonly from: string;
  readonly backend: string;
  readonly relation: string;
  readonly median_error_mm: number;
  readonly worst_error_mm: number;
}

/** Plots the errors of all narrow phases, side by side for each relation of tool and triangle. */
function errors(pointers: readonly string[]): HTMLElement[] {
  const rows = pointers.map((from) => ({ ...(valueAt(from) as NarrowPhaseRow), from }));
  const legend = new Legend(looksOf(rows.map(({ backend }) => backend)));
  // A logarithmic axis cannot show an error of zero.
  const above = (value: number) => (value > 0 ? value : Number.NaN);
  const middle = ({ median_error_mm }: NarrowPhaseRow) => above(median_error_mm);
  const worst = ({ worst_error_mm }: NarrowPhaseRow) => above(worst_error_mm);
  const inscribed = (from: string) => [{ from: `${from}/backend` }, ", ", { from: `${from}/tool` }];
  const chartOf = (relation: string) =>
    rowChart({
      title: relation,
      description: `Median and worst error of each narrow phase, ${relation}`,
      data: () => rows.filter((row) => row.relation === relation),
      series: ({ backend }) => backend,
      legend,
      tip: ({ from }) =>
        tipOfColumns([shown(`${from}/backend`)], from, narrowPhaseColumns.slice(1)),
      name: ({ from }) => inscribed(from),
      value: ({ from }) => [
        { from: `${from}/median_error_mm`, format: error },
        " to ",
        { from: `${from}/worst_error_mm`, format: error },
      ],
      // All panels have the same axis, so that they can be compared.
      x: () => logarithmic("error [mm]", [...rows.map(middle), ...rows.map(worst)]),
      marks: (seen, channels) => spans(seen, channels, middle, worst),
    });
  const relations = [...new Set(rows.map(({ relation }) => relation))];
  return [
    lead("Filled: the median error, and a line to the worst; no mark where it is nothing."),
    legend.element,
    panels(...relations.map(chartOf)),
  ];
}
