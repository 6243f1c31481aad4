// SPDX-License-Identifier: BSD-3-Clause
/** The sections of a benchmark: plots of the selected rows, then every row. */

import * as Plot from "@observablehq/plot";
import { grouped, make } from "../page/elements.ts";
import { benchmarkMethod } from "./benchmark_method.ts";
import { benchmarkTable, columnsOf } from "./benchmark_table.ts";
import {
  Legend,
  type Look,
  logarithmic,
  looksOf,
  plotSection,
  tickText,
  tipOfColumns,
} from "./charts.ts";
import { comparisonSections } from "./comparison.ts";
import { curves } from "./curves.ts";
import { entries, type Timing, valueAt } from "./record.ts";
import { lead, panels, section } from "./report_page.ts";
import { barInRow, inRow, rowChart, spans } from "./row_chart.ts";
import { ruleColor } from "./runs.ts";
import { type Question, Selection } from "./selection.ts";
import {
  inUnit,
  microseconds,
  paragraphs,
  rounded,
  seconds,
  show,
  shown,
  shownName,
  trimmed,
} from "./shown.ts";

/** A row of a benchmark: one combination on one mesh. */
export interface BenchmarkRow {
  /** The pointer to the row in the record. */
  readonly from: string;
  readonly mesh: string;
  readonly triangles: number;
  readonly vertices: number;
  readonly radius: number | null;
  readonly index: string;
  readonly activation: string;
  readonly solver: string;
  readonly build_s: number;
  readonly bytes_per_triangle: number;
  readonly planes_mean: number;
  readonly reaching_share: number;
  readonly unsolved_share: number;
  readonly collect_us: Timing | null;
  /** Undefined in older records. */
  readonly exact_us?: Timing | null;
  readonly query_us: Timing | null;
  readonly step_query_us: Timing | null;
  readonly activate_us: Timing | null;
  readonly solve_us: Timing | null;
  readonly step_us: Timing | null;
  readonly rate_khz: number | null;
}

type Rows = readonly BenchmarkRow[];

/**
 * Returns the sections for the benchmark and the comparison at these pointers, as far as they
 * exist.
 */
export function benchmarkSections(from: string, comparisonFrom: string): HTMLElement[] {
  const comparison = comparisonSections(comparisonFrom);
  const rows = entries(`${from}/rows`).map((row) => ({
    ...(valueAt(row) as BenchmarkRow),
    from: row,
  }));
  if (rows.length === 0) return comparison;
  const isPart = valueAt("/keepout_record") !== "bench";
  return [
    ...(isPart ? [show(make("h2", { class: "part" }), `${from}/headline`)] : []),
    ...(isPart ? paragraphs(`${from}/account`, "account") : []), // of older records
    ...stepBars(from, rows),
    ...new BenchmarkPlots(from, rows).sections(),
    ...comparison,
    benchmarkTable(from, rows),
    ...conditions(from),
    benchmarkMethod(from, rows),
  ];
}

/**
 * Plots the median step of each index with its fastest solver, among the rows that the headline
 * compares. Older records do not say which.
 */
function stepBars(from: string, rows: Rows): HTMLElement[] {
  const fastest = rows[valueAt<number>(`${from}/fastest`) ?? -1];
  if (!fastest) return [];
  const isAlike = (row: BenchmarkRow) =>
    ["mesh", "triangles", "radius", "activation"].every(
      (key) => row[key as keyof BenchmarkRow] === fastest[key as keyof BenchmarkRow],
    );
  const timed = rows
    .filter((row) => row.step_us && isAlike(row) && answers(row) && !valueAt(`${row.from}/remark`))
    .sort((a, b) => median(a.step_us) - median(b.step_us));
  const data = distinct(timed, ({ index }) => index);
  if (data.length < 2) return [];
  const isOwn = ({ index }: BenchmarkRow) => index === fastest.index;
  return [
    section(
      "The time of a step with each index",
      lead(
        "Median of the whole step, for each index with its fastest solver, under rule ",
        shown(`${fastest.from}/activation`),
        " on ",
        shown(`${fastest.from}/mesh`),
        " with ",
        shown(`${fastest.from}/triangles`, grouped),
        " triangles. Shorter is better.",
      ),
      panels(
        rowChart({
          description: "Median time of a step with each index, the fastest first",
          data: () => data,
          tip,
          name: ({ from }) => [{ from: `${from}/index` }, " with ", { from: `${from}/solver` }],
          value: ({ from }) => [{ from: `${from}/step_us/p50`, format: microseconds }],
          x: () => ({ label: "median step [µs]", grid: true, tickFormat: tickText }),
          marks: (seen, { y }) => [
            Plot.barX(seen, {
              x: (row: BenchmarkRow) => median(row.step_us),
              y,
              fill: (row: BenchmarkRow) => (isOwn(row) ? "var(--rule-certified)" : "var(--soft)"),
              ...barInRow,
            }),
          ],
        }),
      ),
    ),
  ];
}

/** True if a mesh has rows of several sizes; else a plot over the size has one value of x. */
const haveSizes = (rows: Rows): boolean =>
  rows.some((row) =>
    rows.some((other) => other.mesh === row.mesh && other.triangles !== row.triangles),
  );

/** Returns the conditions of the headline. Older records have them in their account. */
function conditions(from: string): HTMLElement[] {
  if (valueAt(`${from}/fastest`) === undefined) return [];
  const row = (which: string) => `${from}/rows/${valueAt(`${from}/${which}`)}`;
  const [others, cores] = [`${from}/others_cores`, `${from}/machine/cores`];
  const isBusy = Number(valueAt(others)) > 0.05 * Number(valueAt(cores));
  return [
    make(
      "p",
      { class: "lead" },
      "The headline compares medians of ",
      shown(`${row("fastest")}/queries`, grouped),
      " steps of the fastest combination, ",
      shown(`${row("slowest")}/queries`, grouped),
      " of the slowest. Motion sphere: ",
      shown(`${row("fastest")}/radius`, inUnit("mm", trimmed)),
      ". Cores that other processes kept busy: ",
      shown(others, (busy) => rounded(busy, 2)),
      " of ",
      shown(cores),
      isBusy ? ". Times are longer, and vary more, than on an idle machine." : ".",
    ),
  ];
}

const sphere = ({ radius }: BenchmarkRow): string =>
  radius === null ? "as far as the motion leads" : `${trimmed(radius)} mm`;
const combination = ({ index, activation, solver }: BenchmarkRow): string =>
  [index, activation, solver].join(", ");
const pairOf = ({ index, solver }: BenchmarkRow): string => [index, solver].join(", ");
const median = (timing: Timing | null | undefined): number => timing?.p50 ?? Number.NaN;
/**
 * True if at most one step in a hundred has no answer: a combination that often fails is not fast.
 */
const answers = ({ unsolved_share }: BenchmarkRow): boolean => unsolved_share <= 0.01;
/** Returns the first row of each name. */
const distinct = (rows: Rows, name: (row: BenchmarkRow) => string): BenchmarkRow[] =>
  rows.filter((row, i) => rows.findIndex((other) => name(other) === name(row)) === i);

/** Returns the rows of the largest mesh, each index, rule and solver once. */
function ofLargest(rows: Rows): BenchmarkRow[] {
  const most = Math.max(...rows.map(({ triangles }) => triangles));
  return rows.filter(({ triangles }) => triangles === most);
}

/** Returns a combination as part of a plot's text. */
const combinationParts = (from: string) =>
  ["index", ", ", "activation", ", ", "solver"].map((part) =>
    part === ", " ? part : { from: `${from}/${part}` },
  );
const shownCombination = (from: string): (Node | string)[] =>
  combinationParts(from).map((part) => (typeof part === "string" ? part : shown(part.from)));

const tip = ({ from }: BenchmarkRow): HTMLElement[] =>
  tipOfColumns(shownCombination(from), from, facts);
const facts = columnsOf(
  "/triangles",
  "/radius",
  "/hits_mean",
  "/planes_mean",
  "/query_us/p50",
  "/query_us/p99",
  "/collect_us/p50",
  "/exact_us/p50",
  "/solve_us/p50",
  "/step_us/p50",
  "/step_us/p99",
  "/build_s",
  "/build_cores",
  "/bytes_per_triangle",
);

/** A published rate, or the rate of a row. */
interface Rate {
  readonly from: string;
  readonly triangles: number;
  readonly series: string;
  readonly khz: number;
}
const published = "Li et al. 2020, their machine";

const stages = [
  { key: "step_query_us", name: "query", color: "var(--stage-query)" },
  { key: "activate_us", name: "activate", color: "var(--stage-activate)" },
  { key: "solve_us", name: "solve", color: "var(--stage-solve)" },
] as const;

/** The plots, and the choices for all of them: mesh, motion sphere, rule. */
class BenchmarkPlots {
  private readonly mesh: Question<BenchmarkRow>;
  private readonly sphere: Question<BenchmarkRow>;
  private readonly rule: Question<BenchmarkRow>;
  private readonly selection: Selection<BenchmarkRow>;

  constructor(
    private readonly from: string,
    private readonly rows: Rows,
  ) {
    const spheres = rows
      .filter(({ radius }) => radius !== null)
      .sort((a, b) => (b.radius ?? 0) - (a.radius ?? 0));
    const mesh = ({ mesh }: BenchmarkRow) => mesh;
    const rule = ({ activation }: BenchmarkRow) => activation;
    // The published rule was timed with most indices and solvers.
    const isPaper = (row: BenchmarkRow) => Number(rule(row) === "paper");
    const rules = distinct(rows, rule).sort((a, b) => isPaper(b) - isPaper(a));
    const radii = distinct(spheres.length > 0 ? spheres : rows, sphere);
    this.mesh = { label: "Mesh", of: mesh, from: "/mesh", answers: distinct(rows, mesh) };
    this.sphere = { label: "Motion sphere", of: sphere, from: "/radius", answers: radii };
    this.rule = { label: "Rule", of: rule, from: "/activation", answers: rules };
    this.selection = new Selection([this.mesh, this.sphere, this.rule]);
  }

  sections(): HTMLElement[] {
    return [
      make("h2", {}, "What is shown"),
      lead(
        "Plots are of one mesh, and of one motion sphere and one rule unless they say otherwise; the table has all rows.",
      ),
      this.selection.element,
      ...this.queries(),
      ...this.rates(),
      ...this.solvers(),
      ...this.stages(),
      ...this.costs(),
    ];
  }

  /** Returns the selected rows, except indices that cannot find anything. */
  private chosen(...ignored: readonly Question<BenchmarkRow>[]): BenchmarkRow[] {
    // The query of certified is not a choice of the user, so it is shown with any sphere.
    const fits = (row: BenchmarkRow) =>
      this.selection.has(row, ...ignored) ||
      (row.radius === null && this.selection.has(row, this.sphere, ...ignored));
    return this.rows.filter((row) => row.reaching_share >= 0.5 && fits(row));
  }

  private legend(part: "index" | "solver"): Legend {
    const label = (name: string) =>
      shown(`${this.rows.find((row) => row[part] === name)?.from}/${part}`);
    return new Legend(looksOf(this.rows.map((row) => row[part])), label, this.selection);
  }

  private queries(): HTMLElement[] {
    if (!this.rows.some(({ query_us }) => query_us)) return [];
    const legend = this.legend("index");
    const data = () =>
      distinct(
        this.chosen().filter(({ query_us }) => query_us),
        ({ triangles, index }) => `${triangles} ${index}`,
      );
    const remarks = entries(`${this.from}/remarks`).flatMap((remark) => [
      make("br"),
      shownName(remark),
      ": ",
      shown(remark),
    ]);
    const middle = ({ query_us }: BenchmarkRow) => median(query_us);
    const first = ({ collect_us }: BenchmarkRow) => median(collect_us);
    const last = ({ query_us }: BenchmarkRow) => query_us?.p99 ?? median(query_us);
    const over = (title: string, y: string, of: (row: BenchmarkRow) => number) =>
      curves({
        title: `${title} over the size of the mesh`,
        description: `Median of the ${y} against the number of triangles, for each index`,
        data,
        series: ({ index }) => index,
        x: ["triangles", ({ triangles }) => triangles],
        y: [`${y} [µs]`, of],
        legend,
        tip,
      });
    return [
      plotSection(
        "Which index finds the triangles fastest",
        [
          "The same work for every index, apart from the step: all triangles where the rule looks, by the exact test, with their closest points, sorted. Candidates only is what the index proposes, before that. The flatter a line, if lines are drawn, the less a finer mesh costs.",
          ...remarks,
        ],
        legend,
        ...(haveSizes(this.rows)
          ? [over("Query", "query", middle), over("Candidates only", "candidates", first)]
          : []),
        ...(haveSizes(this.rows) && this.rows.some(({ exact_us }) => exact_us)
          ? [over("Exact test", "exact test", ({ exact_us }) => median(exact_us))]
          : []),
        rowChart({
          title: "On the largest: candidates only, median, 99 %",
          description: "Median time of a query and its 99 %, for each index, the fastest first",
          data: () => ofLargest(data()).sort((a, b) => middle(a) - middle(b)),
          series: ({ index }) => index,
          legend,
          tip,
          name: ({ from }) => [{ from: `${from}/index` }],
          value: ({ from }) => [{ from: `${from}/query_us/p50`, format: microseconds }],
          x: (rows) =>
            logarithmic(
              "query [µs]",
              [first, middle, last].flatMap((of) => rows.map(of)),
            ),
          marks: (seen, channels) => {
            const [line, dot] = spans(seen, channels, middle, last);
            const { y, color, symbol } = channels;
            const own = { x: first, y, ...inRow, symbol, fill: "var(--card)", stroke: color };
            return [line, Plot.dot(seen, own), dot];
          },
        }),
      ),
    ];
  }

  /**
   * Returns the rates of each rule, ours and its reference; all combinations if there is neither.
   */
  private rates(): HTMLElement[] {
    const pairs = entries(`${this.from}/pairs`).map((pair) => [
      valueAt(`${pair}/index`),
      valueAt(`${pair}/solver`),
    ]);
    const isPair = ({ index, solver }: BenchmarkRow) =>
      pairs.some(([one, other]) => index === one && solver === other);
    const told = this.rows.filter(({ rate_khz }) => rate_khz !== null);
    const shownRows = told.some(isPair) ? told.filter(isPair) : told;
    // Rates of one size have no slope to compare with that of the published ones.
    if (!haveSizes(shownRows)) return [];
    const stars = entries(`${this.from}/published`).map((from): Rate => {
      return { ...(valueAt(from) as Rate), from, series: published };
    });
    const looks = new Map<string, Look>();
    // Each rule has its color, and each index and solver a symbol.
    const pairLooks = looksOf(shownRows.map(pairOf));
    for (const row of shownRows) {
      const symbol = pairLooks.get(pairOf(row))?.symbol ?? "circle";
      looks.set(combination(row), { color: `var(${ruleColor(row.activation)})`, symbol });
    }
    looks.set(published, { color: "var(--ink)", symbol: "star" });
    const legend = new Legend(
      looks,
      (name) => {
        const row = shownRows.find((one) => combination(one) === name);
        return row ? make("span", {}, ...shownCombination(row.from)) : name;
      },
      this.selection,
    );
    const data = (): Rate[] => [
      ...stars,
      ...this.chosen(this.rule)
        .filter((row) => shownRows.includes(row) && answers(row))
        .map((row) => ({ ...row, series: combination(row), khz: row.rate_khz ?? Number.NaN })),
    ];
    const columns = (series: string) => [
      ...columnsOf("/triangles"),
      { heading: "vertices", from: "/vertices", format: grouped },
      {
        heading: "rate",
        from: series === published ? "/khz" : "/rate_khz",
        format: inUnit("kHz"),
      },
    ];
    // Over vertices, the plot would be the same: a closed mesh has half as many as triangles.
    const overTriangles = curves({
      description: "Rate of the whole step against the number of triangles, and as published",
      data,
      series: ({ series }) => series,
      x: ["triangles", ({ triangles }) => triangles],
      y: ["rate of the whole step [kHz]", ({ khz }) => khz],
      legend,
      tip: ({ from, series }) =>
        tipOfColumns(
          series === published ? [published] : shownCombination(from),
          from,
          columns(series),
        ),
      rule: [1, "1 kHz"],
    });
    const rates = stars.flatMap(({ from }, i) => [
      i > 0 ? " and " : "",
      shown(`${from}/khz`, inUnit("kHz", String)),
      " at ",
      shown(`${from}/triangles`, grouped),
    ]);
    return [
      plotSection(
        "How often a step fits into a second",
        [
          "Rates of the median step, under every rule. The stars are what Li et al. 2020 published for the Stanford bunny, ",
          ...rates,
          " triangles on an Intel i7-8700, another machine. They state neither the motions nor the motion sphere of that run. Compare the slopes, not the heights.",
        ],
        legend,
        overTriangles,
      ),
    ];
  }

  private solvers(): HTMLElement[] {
    if (!this.rows.some(({ planes_mean, solve_us }) => solve_us && planes_mean > 0)) return [];
    const legend = this.legend("solver");
    const plot = (key: "p50" | "p99", label: string) =>
      curves({
        title: `Time to solve, ${label}`,
        description: `Time of the search for the motion, ${label}, against the mean number of planes`,
        data: () => this.chosen(this.sphere),
        series: ({ solver }) => solver,
        x: ["planes (mean)", ({ planes_mean }) => planes_mean],
        y: ["solve [µs]", ({ solve_us }) => solve_us?.[key] ?? Number.NaN],
        isLoose: true,
        legend,
        tip,
      });
    return [
      plotSection(
        "Which solver copes with many planes",
        [
          "Each solver has the same motions; a mark for each row, whatever its sphere, those with steps without an answer too. Planes that are not in the way are left out for one that can tell that they have no bearing on its answer.",
        ],
        legend,
        plot("p50", "median"),
        plot("p99", "99 %"),
      ),
    ];
  }

  private stages(): HTMLElement[] {
    if (!this.rows.some(({ step_us }) => step_us)) return [];
    const looks = stages.map(({ name, color }) => [name, { color, symbol: "square" }] as const);
    const legend = new Legend(new Map(looks), undefined, this.selection);
    const parts = (rows: Rows) =>
      rows.flatMap((row, place) =>
        stages
          .filter(({ name }) => legend.shows(name))
          .map(({ key, color }) => ({ place, color, time: row[key]?.p50 ?? 0 })),
      );
    const stack = {
      offset: "normalize",
      x: "time",
      y: "place",
      fill: "color",
      ...barInRow,
    } as const;
    return [
      plotSection(
        "Where the time of a step goes",
        [
          "On the largest mesh, the fastest first. Stages are timed in a round of their own, so that the whole step, at the right, is timed without any clock within. There is no query where the rule searches the tree by itself.",
        ],
        legend,
        rowChart({
          description: "Which part of the median step is which, for each combination",
          data: () =>
            ofLargest(this.chosen().filter((row) => row.step_us && answers(row))).sort(
              (a, b) => median(a.step_us) - median(b.step_us),
            ),
          legend,
          tip,
          name: ({ from }) => combinationParts(from),
          value: ({ from }) => [{ from: `${from}/step_us/p50`, format: microseconds }],
          x: () => ({ label: "share of the stages", tickFormat: "%" }),
          marks: (seen) => [
            Plot.barX(parts(seen), Plot.stackX({ ...stack, stroke: "var(--card)" })),
          ],
        }),
      ),
    ];
  }

  private costs(): HTMLElement[] {
    if (!this.rows.some(({ build_s }) => build_s > 0)) return [];
    const legend = this.legend("index");
    const cores = inUnit("cores", (count) => rounded(count, 2));
    const built = () =>
      this.rows.filter((row) => row.build_s > 0 && this.selection.has(row, this.sphere, this.rule));
    const bars = (title: string, cost: "build_s" | "bytes_per_triangle", unit: string) =>
      rowChart({
        title,
        description: `${title}, for each index`,
        data: () =>
          distinct(ofLargest(built()), ({ index }) => index).sort((a, b) => a[cost] - b[cost]),
        series: ({ index }) => index,
        legend,
        tip,
        name: ({ from }) => [{ from: `${from}/index` }],
        value: ({ from }) => [
          { from: `${from}/${cost}`, format: cost === "build_s" ? seconds : inUnit(unit) },
          ...(cost === "build_s" ? [", ", { from: `${from}/build_cores`, format: cores }] : []),
        ],
        x: () => ({ label: `${title} [${unit}]`, grid: true, tickFormat: tickText }),
        marks: (seen, { y, color }) => [Plot.barX(seen, { x: cost, y, fill: color, ...barInRow })],
      });
    return [
      plotSection(
        "What an index costs before the first query",
        [
          "Each is built once on each mesh; shown is the largest. Cores busy are the processor’s time of all threads of this process over the time on the clock.",
        ],
        legend,
        bars("Time to build", "build_s", "s"),
        bars("Memory for a triangle", "bytes_per_triangle", "B"),
      ),
    ];
  }
}
