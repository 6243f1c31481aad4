// SPDX-License-Identifier: BSD-3-Clause
/** The sections of a benchmark: what was found, each with a plot, then every row. */
import * as Plot from "@observablehq/plot";
import { benchmarkMethod } from "./benchmark_method.ts";
import {
  BenchmarkRecord,
  type BenchmarkRow,
  combination,
  type FindingGroup,
  hasSizes,
  nameOf,
  type Rate,
  shownCombination,
} from "./benchmark_rows.ts";
import { benchmarkTable, columnsOf } from "./benchmark_table.ts";
import { Legend, type Look, logarithmic, looksOf, tickText, tipOfColumns } from "./charts.ts";
import { choice } from "./choice.ts";
import { comparisonSections } from "./comparison.ts";
import { curves } from "./curves.ts";
import { entries, type Timing, valueAt } from "./record.ts";
import { lead, panel, panels, section } from "./report_page.ts";
import { barInRow, inRow, rowChart } from "./row_chart.ts";
import {
  grouped,
  inUnit,
  make,
  microseconds,
  paragraphs,
  rounded,
  show,
  shown,
  shownName,
} from "./shown.ts";

/** Those of the benchmark and of the comparison at these pointers, as far as there are such. */
export function benchmarkSections(from: string, comparisonFrom: string): HTMLElement[] {
  const benchmark = new BenchmarkRecord(from);
  const { rows } = benchmark;
  const comparison = comparisonSections(comparisonFrom);
  if (rows.length === 0) return comparison;
  const isPart = valueAt("/keepout_record") !== "bench";
  const indices = looksOf(rows.map(({ index }) => index));
  return [
    ...(isPart ? [show(make("h2", { class: "part" }), `${from}/headline`)] : []),
    ...(isPart ? paragraphs(`${from}/account`, "account") : []),
    ...querySection(benchmark, indices),
    ...rateSection(benchmark),
    ...solverSection(benchmark),
    ...stageSection(benchmark),
    ...costSection(benchmark, indices),
    ...comparison,
    benchmarkTable(benchmark),
    benchmarkMethod(benchmark),
  ];
}

/** What is to be seen in some findings. */
interface Topic {
  readonly about: string;
  readonly title: string;
  readonly words: readonly (Node | string)[];
  /** Whether each motion sphere is by itself. */
  readonly apart?: boolean;
  readonly legend?: Legend;
  readonly draw: (rows: readonly BenchmarkRow[]) => readonly HTMLElement[];
}

/** A section of findings, mesh by mesh, each under its texts and with what draws its rows. */
function topicSection(benchmark: BenchmarkRecord, topic: Topic): HTMLElement[] {
  const { about, title, words, apart = false, legend, draw } = topic;
  const found = benchmark.found(about, apart);
  if (found.length === 0) return [];
  const texts = ({ texts: [first = "", ...others] }: FindingGroup) =>
    others.length === 0
      ? show(lead(), first)
      : make("ul", { class: "lead" }, ...[first, ...others].map((one) => show(make("li"), one)));
  const choices = found.map((group) => ({
    label: nameOf(group.rows, apart),
    content: make("div", {}, texts(group), ...draw(group.rows)),
  }));
  const legends = legend ? [legend.element] : [];
  return [section(title, lead(...words), ...legends, ...choice("Shown:", choices))];
}

const median = (timing: Timing | null): number => timing?.p50 ?? Number.NaN;

/** What stands in a legend for a name: that of the first row that has it. */
const nameShown = (rows: readonly BenchmarkRow[], part: "index" | "solver") => (name: string) =>
  shown(`${rows.find((row) => row[part] === name)?.from}/${part}`);

const queryTip = (row: BenchmarkRow): HTMLElement[] =>
  tipOfColumns(
    [shown(`${row.from}/index`)],
    row.from,
    columnsOf(
      "/triangles",
      "/radius",
      "/query_us/p50",
      "/query_us/p99",
      "/collect_us/p50",
      "/hits_mean",
    ),
  );

function querySection(benchmark: BenchmarkRecord, looks: ReadonlyMap<string, Look>): HTMLElement[] {
  const legend = new Legend(looks, nameShown(benchmark.rows, "index"));
  const remarks = entries(`${benchmark.from}/remarks`).flatMap((remark) => [
    make("br"),
    shownName(remark),
    ": ",
    shown(remark),
  ]);
  const lines = (rows: readonly BenchmarkRow[], stage: "query_us" | "collect_us", label: string) =>
    curves({
      description: `Median of the ${label} against the number of triangles, for each index`,
      data: rows,
      series: ({ index }) => index,
      x: ["triangles", ({ triangles }) => triangles],
      y: [`${label} [µs]`, (row) => median(row[stage])],
      legend,
      tip: queryTip,
    });
  return topicSection(benchmark, {
    about: "queries",
    title: "Which index finds the triangles fastest",
    words: [
      "The same work for every index, apart from the step: all triangles where the rule looks, by the " +
        "exact test, with their closest points, sorted. Candidates only is what the index proposes, " +
        "before that.",
      ...remarks,
    ],
    apart: true,
    legend,
    draw: (rows) =>
      hasSizes(rows)
        ? [
            panels(
              panel("The whole query", lines(rows, "query_us", "query")),
              panel("Candidates only", lines(rows, "collect_us", "candidates only")),
            ),
          ]
        : [
            lead(
              "Filled: the median of the whole query, and a line to its 99 %; open: the median of the " +
                "candidates only.",
            ),
            panels(panel("", queryRows(rows, legend))),
          ],
  });
}

function queryRows(rows: readonly BenchmarkRow[], legend: Legend): HTMLElement {
  const last = ({ query_us }: BenchmarkRow) => query_us?.p99 ?? median(query_us);
  const first = ({ collect_us }: BenchmarkRow) => median(collect_us);
  const middle = ({ query_us }: BenchmarkRow) => median(query_us);
  return rowChart({
    description: "Median time of a query and its 99 %, for each index, the fastest first",
    data: [...rows].sort((a, b) => middle(a) - middle(b)),
    series: ({ index }) => index,
    legend,
    tip: queryTip,
    name: ({ from }) => [{ from: `${from}/index` }],
    value: ({ from }) => [{ from: `${from}/query_us/p50`, format: microseconds }],
    x: logarithmic("query [µs]", [...rows.map(first), ...rows.map(middle), ...rows.map(last)]),
    marks: (seen, { y, color, symbol }) => [
      Plot.link(seen, {
        x1: middle,
        x2: last,
        y1: y,
        y2: y,
        ...inRow,
        stroke: color,
        strokeWidth: 2,
      }),
      Plot.dot(seen, { x: first, y, ...inRow, symbol, fill: "var(--card)", stroke: color, r: 4.5 }),
      Plot.dot(seen, { x: middle, y, ...inRow, symbol, fill: color, r: 5 }),
    ],
  });
}

const published = "Li et al. 2020, their machine";
const kilohertz = inUnit("kHz");

function rateSection(benchmark: BenchmarkRecord): HTMLElement[] {
  const stars = entries(`${benchmark.from}/published`).map((from): Rate => {
    const { khz, ...sizes } = valueAt(from) as { triangles: number; vertices: number; khz: number };
    return { ...sizes, from, series: published, rate: khz, key: "khz" };
  });
  const told = stars.flatMap(({ from }, i) => [
    i > 0 ? " and " : "",
    shown(`${from}/khz`, inUnit("kHz", String)),
    " at ",
    shown(`${from}/triangles`, grouped),
  ]);
  return topicSection(benchmark, {
    about: "rates",
    title: "How often a step fits into a second",
    words: [
      "Rates of the median step. The stars are what Li et al. 2020 published for the Stanford bunny, ",
      ...told,
      " triangles on an Intel i7-8700, another machine. They state neither the motions nor the motion " +
        "sphere of that run.",
      hasSizes(benchmark.rows) ? " Compare the slopes, not the heights." : "",
    ],
    draw: (rows) => {
      const own = rows.map((row): Rate => {
        const { from, triangles, vertices, rate_khz } = row;
        const series = combination(row);
        return { from, triangles, vertices, series, rate: rate_khz ?? Number.NaN, key: "rate_khz" };
      });
      const star: [string, Look] = [published, { color: "var(--ink)", symbol: "star" }];
      const legend = new Legend(
        new Map([...looksOf(own.map(({ series }) => series)), star]),
        (name) => {
          const row = rows.find((one) => combination(one) === name);
          return row ? make("span", {}, ...shownCombination(row.from)) : name;
        },
      );
      const all = [...own, ...stars];
      if (!hasSizes(rows)) return [panels(panel("", rateRows(all, legend)))];
      const over = (size: "triangles" | "vertices") => ({
        label: [size],
        content: panels(panel(`Over ${size}`, rateLines(all, size, legend))),
      });
      return [legend.element, ...choice("Over", [over("triangles"), over("vertices")])];
    },
  });
}

const rateTip = ({ from, series, key }: Rate): HTMLElement[] =>
  tipOfColumns(series === published ? [published] : shownCombination(from), from, [
    ...columnsOf("/triangles"),
    { heading: "vertices", from: "/vertices", format: grouped },
    { heading: "rate", from: `/${key}`, format: kilohertz },
    ...(series === published ? [] : columnsOf("/radius", "/step_us/p50", "/step_us/p99")),
  ]);

const rateLines = (rates: readonly Rate[], size: "triangles" | "vertices", legend: Legend) =>
  curves({
    description: `Rate of the whole step against the number of ${size}, for each combination, and as published`,
    data: rates,
    series: ({ series }) => series,
    x: [size, (rate) => rate[size]],
    y: ["rate of the whole step [kHz]", ({ rate }) => rate],
    legend,
    tip: rateTip,
    rule: [1, "1 kHz"],
  });

const rateRows = (rates: readonly Rate[], legend: Legend) =>
  rowChart({
    description: "Rate of the whole step, for each combination, and as published",
    data: rates,
    series: ({ series }) => series,
    legend,
    tip: rateTip,
    name: ({ from, series }) =>
      series === published
        ? ["Li et al. 2020, ", { from: `${from}/triangles`, format: grouped }, " triangles"]
        : combinationParts(from),
    value: ({ from, key }) => [{ from: `${from}/${key}`, format: kilohertz }],
    x: logarithmic("rate of the whole step [kHz]", [1, ...rates.map(({ rate }) => rate)]),
    marks: (seen, { y, color, symbol }) => [
      Plot.ruleX([1], { stroke: "var(--soft)", strokeDasharray: "5 4" }),
      Plot.dot(seen, { x: "rate", y, ...inRow, symbol, fill: color, r: 5.5 }),
    ],
  });

/** A combination within the text of a plot. */
const combinationParts = (from: string) => [
  { from: `${from}/index` },
  ", ",
  { from: `${from}/activation` },
  ", ",
  { from: `${from}/solver` },
];

function solverSection(benchmark: BenchmarkRecord): HTMLElement[] {
  const looks = looksOf(benchmark.rows.map(({ solver }) => solver));
  const legend = new Legend(looks, nameShown(benchmark.rows, "solver"));
  const facts = columnsOf(
    "/triangles",
    "/radius",
    "/planes_mean",
    "/solve_us/p50",
    "/solve_us/p99",
  );
  const lines = (rows: readonly BenchmarkRow[], key: "p50" | "p99", label: string) =>
    panel(
      `Time to solve, ${label}`,
      curves({
        description: `Time of the search for the motion, ${label}, against the mean number of planes, for each solver`,
        data: rows,
        series: ({ solver }) => solver,
        x: ["planes (mean)", ({ planes_mean }) => planes_mean],
        y: ["solve [µs]", ({ solve_us }) => solve_us?.[key] ?? Number.NaN],
        legend,
        tip: ({ from }) => tipOfColumns(shownCombination(from), from, facts),
      }),
    );
  return topicSection(benchmark, {
    about: "solvers",
    title: "Which solver copes with many planes",
    words: [
      "Each solver has the same motions. Planes that are not in the way are left out for one that can " +
        "tell that they have no bearing on its answer.",
    ],
    legend,
    draw: (rows) =>
      choice("Time to solve:", [
        { label: ["median"], content: panels(lines(rows, "p50", "median")) },
        { label: ["99 %"], content: panels(lines(rows, "p99", "99 %")) },
      ]),
  });
}

const stages = [
  { key: "step_query_us", name: "query", color: "var(--stage-query)" },
  { key: "activate_us", name: "activate", color: "var(--stage-activate)" },
  { key: "solve_us", name: "solve", color: "var(--stage-solve)" },
] as const;

function stageSection(benchmark: BenchmarkRecord): HTMLElement[] {
  const legend = new Legend(
    new Map(stages.map(({ name, color }) => [name, { color, symbol: "square" }])),
  );
  const facts = columnsOf(
    ...stages.map(({ key }) => `/${key}/p50`),
    "/step_us/p50",
    "/step_us/p99",
  );
  const parts = (rows: readonly BenchmarkRow[]) =>
    rows.flatMap((row, place) =>
      stages
        .filter(({ name }) => legend.shows(name))
        .map(({ key, color }) => ({ place, color, time: row[key]?.p50 ?? 0 })),
    );
  const stack = { offset: "normalize", x: "time", y: "place", fill: "color", ...barInRow } as const;
  const bars = (rows: readonly BenchmarkRow[]) =>
    rowChart({
      description: "Which part of the median step is which, for each combination",
      data: rows,
      legend,
      tip: ({ from }) => tipOfColumns(shownCombination(from), from, facts),
      name: ({ from }) => combinationParts(from),
      value: ({ from }) => [{ from: `${from}/step_us/p50`, format: microseconds }],
      x: { label: "share of the stages", tickFormat: "%" },
      marks: (seen) => [Plot.barX(parts(seen), Plot.stackX({ ...stack, stroke: "var(--card)" }))],
    });
  return topicSection(benchmark, {
    about: "stages",
    title: "Where the time of a step goes",
    words: [
      "Stages are timed in a round of their own, so that the whole step, at the right, is timed without " +
        "any clock within.",
    ],
    apart: true,
    legend,
    draw: (rows) => [panels(panel("", bars(rows)))],
  });
}

function costSection(benchmark: BenchmarkRecord, looks: ReadonlyMap<string, Look>): HTMLElement[] {
  const facts = columnsOf("/triangles", "/build_s", "/build_cores", "/bytes_per_triangle");
  const cores = inUnit("cores", (count) => rounded(count, 2));
  const bars = (rows: readonly BenchmarkRow[], cost: "build_s" | "bytes_per_triangle") => {
    const isTime = cost === "build_s";
    const value = (from: string) => ({
      from: `${from}/${cost}`,
      format: inUnit(isTime ? "s" : "B"),
    });
    return rowChart({
      description: isTime ? "Time to build each index" : "Memory of each index for a triangle",
      data: [...rows].sort((a, b) => a[cost] - b[cost]),
      series: ({ index }) => index,
      legend: new Legend(looks),
      tip: ({ from }) => tipOfColumns([shown(`${from}/index`)], from, facts),
      name: ({ from }) => [{ from: `${from}/index` }],
      value: ({ from }) =>
        isTime
          ? [value(from), ", ", { from: `${from}/build_cores`, format: cores }]
          : [value(from)],
      x: { label: isTime ? "build [s]" : "bytes a triangle", grid: true, tickFormat: tickText },
      marks: (seen, { y, color }) => [Plot.barX(seen, { x: cost, y, fill: color, ...barInRow })],
    });
  };
  return topicSection(benchmark, {
    about: "costs",
    title: "What an index costs before the first query",
    words: [
      "Each is built once on each mesh. Cores busy are the processor’s time of all threads of this " +
        "process over the time on the clock.",
    ],
    draw: (rows) => [
      panels(
        panel("Time to build, and cores busy", bars(rows, "build_s")),
        panel("Memory for a triangle", bars(rows, "bytes_per_triangle")),
      ),
    ],
  });
}
