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
  shownCombination,
  shownSphere,
} from "./benchmark_rows.ts";
import { benchmarkTable } from "./benchmark_table.ts";
import {
  barInRow,
  chart,
  inRow,
  Legend,
  type Look,
  logarithmic,
  looksOf,
  rowPlot,
  tickText,
  tipOf,
} from "./charts.ts";
import { choice } from "./choice.ts";
import { comparisonSections } from "./comparison.ts";
import { entries, valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import {
  grouped,
  inUnit,
  make,
  mean,
  microseconds,
  rounded,
  show,
  shown,
  shownName,
} from "./shown.ts";

/** Those of the benchmark and of the comparison at these pointers, as far as there are such. */
export function benchmarkSections(from: string, comparisonFrom: string): HTMLElement[] {
  const benchmark = new BenchmarkRecord(from);
  const middle = comparisonSections(comparisonFrom);
  if (benchmark.rows.length === 0) return middle;
  const indices = looksOf(benchmark.rows.map(({ index }) => index));
  const solvers = looksOf(benchmark.rows.map(({ solver }) => solver));
  return [
    ...querySection(benchmark, indices),
    ...rateSection(benchmark),
    ...solverSection(benchmark, solvers),
    ...stageSection(benchmark),
    ...costSection(benchmark, indices),
    ...middle,
    benchmarkTable(benchmark),
    benchmarkMethod(benchmark),
  ];
}

const panels = (...figures: readonly HTMLElement[]): HTMLElement =>
  make("div", { class: "panels wide charts", style: `--columns:${figures.length}` }, ...figures);

function panel(title: readonly (Node | string)[], ...content: readonly Node[]): HTMLElement {
  const caption = make("figcaption", {}, make("span", { class: "name" }, ...title));
  return make("figure", { class: "measured" }, ...(title.length > 0 ? [caption] : []), ...content);
}

/** What was found, group by group, each under its texts and with what draws it. */
function groups(
  found: readonly FindingGroup[],
  label: (first: BenchmarkRow) => readonly (Node | string)[],
  draw: (group: FindingGroup) => readonly HTMLElement[],
): HTMLElement[] {
  return choice(
    "Shown:",
    found.flatMap((group) => {
      const first = group.rows[0];
      if (!first) return [];
      const texts =
        group.texts.length === 1
          ? group.texts.map((text) => show(make("p", { class: "lead" }), text))
          : [make("ul", { class: "lead" }, ...group.texts.map((text) => show(make("li"), text)))];
      return [{ label: label(first), content: make("div", {}, ...texts, ...draw(group)) }];
    }),
  );
}

/** Which mesh, where there are several, and which sphere, where each is by itself. */
function nameOf(found: readonly FindingGroup[], first: BenchmarkRow, apart: boolean) {
  const meshes = new Set(found.map(({ rows }) => rows[0]?.mesh));
  const mesh = meshes.size > 1 || !apart ? [shown(`${first.from}/mesh`)] : [];
  const sphere = apart ? shownSphere(first) : [];
  return [...mesh, ...(mesh.length > 0 && apart ? [", "] : []), ...sphere];
}

const timeFacts = (row: BenchmarkRow, key: string, name: string): (readonly [string, Node])[] => [
  [`${name}, median`, shown(`${row.from}/${key}/p50`, microseconds)],
  ["99 %", shown(`${row.from}/${key}/p99`, microseconds)],
];

const sizeFact = (row: BenchmarkRow): readonly [string, Node] => [
  "triangles",
  shown(`${row.from}/triangles`, grouped),
];

function querySection(benchmark: BenchmarkRecord, looks: ReadonlyMap<string, Look>): HTMLElement[] {
  const found = benchmark.found("queries", true);
  if (found.length === 0) return [];
  const legend = new Legend(looks, nameShown(benchmark, "index"));
  const remarks = entries(`${benchmark.from}/remarks`).map((remark) =>
    lead(shownName(remark), ": ", shown(remark)),
  );
  const isCurve = found.some(({ rows }) => hasSizes(rows));
  return [
    section(
      "Which index finds the triangles fastest",
      lead(
        "The same work for every index, apart from the step: all triangles where the rule looks, by " +
          "the exact test, with their closest points, sorted. Candidates only is what the index " +
          "proposes, before that." +
          (isCurve
            ? ""
            : " Filled: the median of the whole query, and a line to its 99 %; open: the median of " +
              "the candidates only."),
      ),
      ...remarks,
      legend.element,
      ...groups(
        found,
        (first) => nameOf(found, first, true),
        ({ rows }) => [
          hasSizes(rows)
            ? panels(
                panel(["The whole query"], queryLines(rows, "query_us", "query [µs]", legend)),
                panel(
                  ["Candidates only"],
                  queryLines(rows, "collect_us", "candidates only [µs]", legend),
                ),
              )
            : panels(panel([], queryRows(rows, legend))),
        ],
      ),
    ),
  ];
}

/** What stands in a legend for a name: that of the first row that has it. */
const nameShown =
  (benchmark: BenchmarkRecord, part: "index" | "solver") =>
  (name: string): Node => {
    const row = benchmark.rows.find((one) => one[part] === name);
    return row ? shown(`${row.from}/${part}`) : document.createTextNode(name);
  };

const queryTip = (row: BenchmarkRow): HTMLElement[] =>
  tipOf(
    [shown(`${row.from}/index`)],
    [
      sizeFact(row),
      ...timeFacts(row, "query_us", "query"),
      ["candidates only", shown(`${row.from}/collect_us/p50`, microseconds)],
      ["hits, mean", shown(`${row.from}/hits_mean`, mean)],
    ],
  );

/** Lines through the marks of each series, on two logarithmic axes. */
function linesWithMarks(
  rows: readonly BenchmarkRow[],
  name: (row: BenchmarkRow) => string,
  look: (name: string) => Look,
  [x, y]: readonly [(row: BenchmarkRow) => number, (row: BenchmarkRow) => number],
): Plot.Markish[] {
  const sorted = [...rows].sort((a, b) => x(a) - x(b));
  const color = (row: BenchmarkRow) => look(name(row)).color;
  const symbol = (row: BenchmarkRow) => look(name(row)).symbol as string;
  return [
    Plot.line(sorted, { x, y, z: name, stroke: color, strokeWidth: 2 }),
    Plot.dot(sorted, { x, y, symbol, fill: color, stroke: "var(--card)", r: 4.5 }),
    Plot.dot(sorted, Plot.pointer({ x, y, stroke: "var(--ink)", strokeWidth: 2, r: 9 })),
  ];
}

function queryLines(
  rows: readonly BenchmarkRow[],
  stage: "query_us" | "collect_us",
  label: string,
  legend: Legend,
): HTMLElement {
  const timed = rows.filter((row) => row[stage] !== null);
  const axes = [
    (row: BenchmarkRow) => row.triangles,
    (row: BenchmarkRow) => row[stage]?.p50 ?? 0,
  ] as const;
  return chart({
    description: `Median of the ${label} against the number of triangles, for each index`,
    legend,
    tip: queryTip,
    draw: () => ({
      height: 400,
      marginLeft: 48,
      inset: 7,
      x: logarithmic("triangles", timed.map(axes[0])),
      y: logarithmic(label, timed.map(axes[1])),
      marks: linesWithMarks(
        timed.filter(({ index }) => legend.shows(index)),
        ({ index }) => index,
        legend.look,
        axes,
      ),
    }),
  });
}

function queryRows(rows: readonly BenchmarkRow[], legend: Legend): HTMLElement {
  const sorted = [...rows].sort((a, b) => (a.query_us?.p50 ?? 0) - (b.query_us?.p50 ?? 0));
  const reach = (row: BenchmarkRow) => row.query_us?.p99 ?? row.query_us?.p50 ?? 0;
  const all = rows.flatMap((row) => [row.collect_us?.p50 ?? 0, row.query_us?.p50 ?? 0, reach(row)]);
  const color = (row: BenchmarkRow) => legend.look(row.index).color;
  const symbol = (row: BenchmarkRow) => legend.look(row.index).symbol as string;
  return chart({
    description: "Median time of a query and its 99 %, for each index, the fastest first",
    legend,
    tip: queryTip,
    draw: () => {
      const seen = sorted.filter(({ index }) => legend.shows(index));
      const place = { y: (_: BenchmarkRow, i: number) => i, ...inRow };
      return rowPlot(
        seen,
        {
          name: ({ from }) => [{ from: `${from}/index` }],
          value: ({ from }) => [{ from: `${from}/query_us/p50`, format: microseconds }],
        },
        logarithmic("query [µs]", all),
        [
          Plot.link(seen, {
            x1: (row: BenchmarkRow) => row.query_us?.p50,
            x2: reach,
            y1: place.y,
            y2: place.y,
            dy: inRow.dy,
            stroke: color,
            strokeWidth: 2,
          }),
          Plot.dot(seen, {
            ...place,
            x: (row: BenchmarkRow) => row.collect_us?.p50,
            symbol,
            fill: "var(--card)",
            stroke: color,
            r: 4.5,
          }),
          Plot.dot(seen, {
            ...place,
            x: (row: BenchmarkRow) => row.query_us?.p50,
            symbol,
            fill: color,
            r: 5,
          }),
        ],
      );
    },
  });
}

/** A rate that others have published, of the whole step. */
interface PublishedRate {
  readonly from: string;
  readonly triangles: number;
  readonly vertices: number;
  readonly khz: number;
}

const published = "Li et al. 2020, their machine";
const kilohertz = inUnit("kHz");

function rateSection(benchmark: BenchmarkRecord): HTMLElement[] {
  const found = benchmark.found("rates");
  if (found.length === 0) return [];
  const stars = entries(`${benchmark.from}/published`).map((from) => ({
    ...(valueAt(from) as PublishedRate),
    from,
  }));
  const rates = stars.flatMap(({ from }, i) => [
    i > 0 ? " and " : "",
    shown(
      `${from}/khz`,
      inUnit("kHz", (khz) => String(Number(khz.toPrecision(3)))),
    ),
    " at ",
    shown(`${from}/triangles`, grouped),
  ]);
  return [
    section(
      "How often a step fits into a second",
      lead(
        "Rates of the median step. The stars are what Li et al. 2020 published for the Stanford bunny, ",
        ...rates,
        " triangles on an Intel i7-8700, another machine. They state neither the motions nor the " +
          "motion sphere of that run. Compare the slopes, not the heights.",
      ),
      ...groups(
        found,
        (first) => nameOf(found, first, false),
        ({ rows }) => {
          const looks = looksOf(rows.map(combination));
          const legend = new Legend(
            new Map([...looks, [published, { color: "var(--ink)", symbol: "star" }]]),
            (name) => {
              const row = rows.find((one) => combination(one) === name);
              return row ? make("span", {}, ...shownCombination(row)) : name;
            },
          );
          if (!hasSizes(rows)) return [panels(panel([], rateRows(rows, stars, legend)))];
          const over = (size: "triangles" | "vertices") => ({
            label: [size],
            content: panels(panel([`Over ${size}`], rateLines(rows, stars, size, legend))),
          });
          return [legend.element, ...choice("Over", [over("triangles"), over("vertices")])];
        },
      ),
    ),
  ];
}

const rateTip = (row: BenchmarkRow | PublishedRate): HTMLElement[] =>
  "khz" in row
    ? tipOf(
        [published],
        [
          ["triangles", shown(`${row.from}/triangles`, grouped)],
          ["vertices", shown(`${row.from}/vertices`, grouped)],
          ["rate", shown(`${row.from}/khz`, kilohertz)],
        ],
      )
    : tipOf(shownCombination(row), [
        sizeFact(row),
        ["vertices", shown(`${row.from}/vertices`, grouped)],
        ["rate", shown(`${row.from}/rate_khz`, kilohertz)],
        ...timeFacts(row, "step_us", "step"),
      ]);

const rateOf = (row: BenchmarkRow): number => row.rate_khz ?? 0;

function rateLines(
  rows: readonly BenchmarkRow[],
  stars: readonly PublishedRate[],
  size: "triangles" | "vertices",
  legend: Legend,
): HTMLElement {
  const axes = [(row: BenchmarkRow) => row[size], rateOf] as const;
  const star = { x: size, y: "khz" };
  return chart<BenchmarkRow | PublishedRate>({
    description: `Rate of the whole step against the number of ${size}, for each combination, and as published`,
    legend,
    tip: rateTip,
    draw: () => {
      const seen = legend.shows(published) ? [...stars] : [];
      return {
        height: 480,
        marginLeft: 48,
        inset: 7,
        x: logarithmic(size, [...rows.map(axes[0]), ...stars.map((one) => one[size])]),
        y: logarithmic("rate of the whole step [kHz]", [
          1,
          ...rows.map(rateOf),
          ...stars.map(({ khz }) => khz),
        ]),
        marks: [
          Plot.ruleY([1], { stroke: "var(--soft)", strokeDasharray: "5 4" }),
          Plot.text([1], {
            y: 1,
            text: () => "1 kHz",
            frameAnchor: "left",
            dx: 4,
            dy: -7,
            fill: "var(--soft)",
          }),
          ...linesWithMarks(
            rows.filter((row) => legend.shows(combination(row))),
            combination,
            legend.look,
            axes,
          ),
          Plot.dot(seen, { ...star, symbol: "star", fill: "var(--ink)", r: 6 }),
          Plot.dot(seen, Plot.pointer({ ...star, stroke: "var(--ink)", strokeWidth: 2, r: 10 })),
        ],
      };
    },
  });
}

function rateRows(
  rows: readonly BenchmarkRow[],
  stars: readonly PublishedRate[],
  legend: Legend,
): HTMLElement {
  const all = [...rows, ...stars];
  const rate = (row: BenchmarkRow | PublishedRate) => ("khz" in row ? row.khz : rateOf(row));
  const look = (row: BenchmarkRow | PublishedRate) =>
    legend.look("khz" in row ? published : combination(row));
  return chart<BenchmarkRow | PublishedRate>({
    description: "Rate of the whole step, for each combination, and as published",
    tip: rateTip,
    draw: () =>
      rowPlot(
        all,
        {
          name: (row) =>
            "khz" in row
              ? [
                  "Li et al. 2020, ",
                  { from: `${row.from}/triangles`, format: grouped },
                  " triangles",
                ]
              : combinationParts(row),
          value: (row) => [
            { from: `${row.from}/${"khz" in row ? "khz" : "rate_khz"}`, format: kilohertz },
          ],
        },
        logarithmic("rate of the whole step [kHz]", [1, ...all.map(rate)]),
        [
          Plot.ruleX([1], { stroke: "var(--soft)", strokeDasharray: "5 4" }),
          Plot.dot(all, {
            ...inRow,
            x: rate,
            y: (_, i: number) => i,
            symbol: (row: BenchmarkRow) => look(row).symbol as string,
            fill: (row) => look(row).color,
            r: 5.5,
          }),
        ],
      ),
  });
}

/** A combination within the text of a plot. */
const combinationParts = ({ from }: BenchmarkRow) => [
  { from: `${from}/index` },
  ", ",
  { from: `${from}/activation` },
  ", ",
  { from: `${from}/solver` },
];

function solverSection(
  benchmark: BenchmarkRecord,
  looks: ReadonlyMap<string, Look>,
): HTMLElement[] {
  const found = benchmark.found("solvers");
  if (found.length === 0) return [];
  const legend = new Legend(looks, nameShown(benchmark, "solver"));
  return [
    section(
      "Which solver copes with many planes",
      lead(
        "Each solver has the same motions. Planes that are not in the way are left out for one that " +
          "can tell that they have no bearing on its answer.",
      ),
      legend.element,
      ...groups(
        found,
        (first) => nameOf(found, first, false),
        ({ rows }) => {
          const of = (percentile: "p50" | "p99", label: string) => ({
            label: [label],
            content: panels(
              panel([`Time to solve, ${label}`], solveLines(rows, percentile, legend)),
            ),
          });
          return choice("Time to solve:", [of("p50", "median"), of("p99", "99 %")]);
        },
      ),
    ),
  ];
}

function solveLines(
  rows: readonly BenchmarkRow[],
  percentile: "p50" | "p99",
  legend: Legend,
): HTMLElement {
  const timed = rows.filter((row) => (row.solve_us?.[percentile] ?? null) !== null);
  const axes = [
    ({ planes_mean }: BenchmarkRow) => planes_mean,
    (row: BenchmarkRow) => row.solve_us?.[percentile] ?? 0,
  ] as const;
  return chart({
    description:
      "Time of the search for the motion against the mean number of planes, for each solver",
    legend,
    tip: (row: BenchmarkRow) =>
      tipOf(shownCombination(row), [
        sizeFact(row),
        ["sphere", make("span", {}, ...shownSphere(row))],
        ["planes, mean", shown(`${row.from}/planes_mean`, mean)],
        ...timeFacts(row, "solve_us", "solve"),
      ]),
    draw: () => ({
      height: 440,
      marginLeft: 48,
      inset: 7,
      x: logarithmic("planes (mean)", timed.map(axes[0])),
      y: logarithmic("solve [µs]", timed.map(axes[1])),
      marks: linesWithMarks(
        timed.filter(({ solver }) => legend.shows(solver)),
        ({ solver }) => solver,
        legend.look,
        axes,
      ),
    }),
  });
}

const stages = [
  { key: "step_query_us", name: "query", color: "var(--stage-query)" },
  { key: "activate_us", name: "activate", color: "var(--stage-activate)" },
  { key: "solve_us", name: "solve", color: "var(--stage-solve)" },
] as const;

function stageSection(benchmark: BenchmarkRecord): HTMLElement[] {
  const found = benchmark.found("stages", true);
  if (found.length === 0) return [];
  const legend = new Legend(
    new Map(stages.map(({ name, color }) => [name, { color, symbol: "square" }])),
  );
  return [
    section(
      "Where the time of a step goes",
      lead(
        "Stages are timed in a round of their own, so that the whole step, at the right, is timed " +
          "without any clock within.",
      ),
      legend.element,
      ...groups(
        found,
        (first) => nameOf(found, first, true),
        ({ rows }) => [panels(panel([], stageRows(rows, legend)))],
      ),
    ),
  ];
}

function stageRows(rows: readonly BenchmarkRow[], legend: Legend): HTMLElement {
  const parts = rows.flatMap((row, place) =>
    stages.map(({ key, name, color }) => ({ place, name, color, time: row[key]?.p50 ?? 0 })),
  );
  return chart({
    description: "Which part of the median step is which, for each combination",
    legend,
    tip: (row: BenchmarkRow) =>
      tipOf(shownCombination(row), [
        ...stages.map(
          ({ key, name }) => [name, shown(`${row.from}/${key}/p50`, microseconds)] as const,
        ),
        ...timeFacts(row, "step_us", "whole step"),
      ]),
    draw: () =>
      rowPlot(
        rows,
        {
          name: combinationParts,
          value: ({ from }) => [{ from: `${from}/step_us/p50`, format: microseconds }],
        },
        { label: "share of the stages", tickFormat: "%" },
        [
          Plot.barX(
            parts.filter(({ name }) => legend.shows(name)),
            Plot.stackX({
              ...barInRow,
              offset: "normalize",
              x: "time",
              y: "place",
              fill: "color",
              stroke: "var(--card)",
            }),
          ),
        ],
      ),
  });
}

function costSection(benchmark: BenchmarkRecord, looks: ReadonlyMap<string, Look>): HTMLElement[] {
  const found = benchmark.found("costs");
  if (found.length === 0) return [];
  return [
    section(
      "What an index costs before the first query",
      lead(
        "Each is built once on each mesh. Cores busy are the processor’s time of all threads of this " +
          "process over the time on the clock",
        ...(valueAt(`${benchmark.from}/machine/cores`)
          ? [", of the ", shown(`${benchmark.from}/machine/cores`), " of this machine"]
          : []),
        ".",
      ),
      ...groups(
        found,
        (first) => nameOf(found, first, false),
        ({ rows }) => [
          panels(
            panel(["Time to build, and cores busy"], costRows(rows, looks, "build_s")),
            panel(["Memory for a triangle"], costRows(rows, looks, "bytes_per_triangle")),
          ),
        ],
      ),
    ),
  ];
}

function costRows(
  rows: readonly BenchmarkRow[],
  looks: ReadonlyMap<string, Look>,
  cost: "build_s" | "bytes_per_triangle",
): HTMLElement {
  const sorted = [...rows].sort((a, b) => a[cost] - b[cost]);
  const isTime = cost === "build_s";
  return chart({
    description: isTime
      ? "Time to build each index"
      : "Memory that each index takes for a triangle",
    tip: ({ from }: BenchmarkRow) =>
      tipOf(
        [shown(`${from}/index`)],
        [
          ["build", shown(`${from}/build_s`, inUnit("s"))],
          ["cores busy", shown(`${from}/build_cores`, (cores) => rounded(cores, 2))],
          ["for a triangle", shown(`${from}/bytes_per_triangle`, inUnit("B"))],
        ],
      ),
    draw: () =>
      rowPlot(
        sorted,
        {
          name: ({ from }) => [{ from: `${from}/index` }],
          value: ({ from }) =>
            isTime
              ? [
                  { from: `${from}/build_s`, format: inUnit("s") },
                  ", ",
                  { from: `${from}/build_cores`, format: inUnit("cores", (n) => rounded(n, 2)) },
                ]
              : [{ from: `${from}/bytes_per_triangle`, format: inUnit("B") }],
        },
        {
          label: isTime ? "time to build [s]" : "bytes a triangle",
          grid: true,
          tickFormat: tickText,
        },
        [
          Plot.barX(sorted, {
            ...barInRow,
            x: cost,
            y: (_, i: number) => i,
            fill: ({ index }: BenchmarkRow) => looks.get(index)?.color ?? "var(--ink)",
          }),
        ],
      ),
  });
}
