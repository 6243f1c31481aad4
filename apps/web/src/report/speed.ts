// SPDX-License-Identifier: BSD-3-Clause
/** The sections of the table of ratios that keepout is held to. */
import * as Plot from "@observablehq/plot";
import { chart, Legend, type Look, logarithmic, tipOf } from "./charts.ts";
import { entries, type Timing, valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { type Format, grouped, make, mean, nanoseconds, rounded, shown, trimmed } from "./shown.ts";
import { type Column, scrolled, table } from "./table.ts";

/** Median, 99 % and 99.9 %, as far as there are enough samples, in one unit. */
function percentiles(from: string): (Node | string)[] {
  const timing = valueAt<Timing>(from);
  if (!timing) return ["–"];
  const isLong = timing.p50 >= 1e4;
  const format: Format = (us) => rounded(isLong ? us / 1e3 : us);
  const times = (["p50", "p99", "p999"] as const).filter((key) => timing[key] !== null);
  return [
    ...times.flatMap((key, i) => [i > 0 ? " / " : "", shown(`${from}/${key}`, format)]),
    isLong ? "\u00a0ms" : "\u00a0µs",
  ];
}

/** What is behind a figure of a row. */
const unitOf = (row: string): string => {
  const unit = valueAt<string>(`${row}/unit`) ?? "";
  return unit === "x" || unit === "" ? unit : `\u00a0${unit}`;
};

const ratioColumns: readonly Column[] = [
  {
    heading: "Work",
    from: "/work",
    look: "words",
    content: (row) => [shown(`${row}/work`), ": ", shown(`${row}/compared`)],
  },
  {
    heading: "Demanded",
    from: "/demanded",
    content: (row) => [
      ...entries(`${row}/demanded`).flatMap((demand) => [
        demand.endsWith("/at_least") ? "at least " : "at most ",
        shown(demand, (value) => trimmed(value) + unitOf(row)),
      ]),
    ],
  },
  {
    heading: "Measured",
    from: "/figure",
    content: (row) => {
      const format: Format = (figure) =>
        (valueAt(`${row}/unit`) === "x" ? rounded(figure) : trimmed(figure, 3)) + unitOf(row);
      if (valueAt(`${row}/figure`) === null) return ["not measured"];
      const figure = shown(`${row}/figure`, format);
      return valueAt(`${row}/met`) ? [figure] : [make("b", { class: "bad" }, figure, ", short")];
    },
  },
  {
    heading: "Made of",
    from: "/remark",
    look: "words",
    content: (row) => {
      const sides = entries(`${row}/sides`).map((side) => [
        shown(`${side}/name`),
        " ",
        ...percentiles(`${side}/us`),
        (valueAt<number>(`${side}/batch`) ?? 1) > 1 ? " *" : "",
      ]);
      const remark = valueAt(`${row}/remark`) ? [[shown(`${row}/remark`)]] : [];
      return [...sides, ...remark].flatMap((part, i) => [i > 0 ? "; " : "", ...part]);
    },
  },
];

const queryColumns: readonly Column[] = [
  { heading: "Index", from: "/index" },
  { heading: "r [mm]", from: "/radius" },
  { heading: "Triangles found", from: "/found_mean", format: mean },
  ...[
    ["Candidates", "/candidates_us"],
    ["Answer", "/answer_us"],
    ["By a lean exact test", "/lean_answer_us"],
  ].map(([heading = "", from = ""]) => ({
    heading,
    from: `${from}/p50`,
    content: (row: string) => percentiles(row + from),
  })),
];

/** Ratios, the histogram of many steps, and queries. */
export function speedSections(): HTMLElement[] {
  return [ratioSection(), ...histogramSection(), ...querySection()];
}

function ratioSection(): HTMLElement {
  const ratios = section(
    "What is demanded, and what was measured",
    lead(
      "Of ",
      shown("/mesh"),
      " unless said, on one core unless said. Beside each figure what it is made of: median / 99 % / " +
        "99.9 %. A median of a fraction of a microsecond, marked *, is that of batches; reading the " +
        "clock, which all other times include, takes ",
      shown("/machine/clock_ns", (ns) => `${rounded(ns, 2)}\u00a0ns`),
      ".",
    ),
    scrolled(table(entries("/rows"), ratioColumns)),
  );
  ratios.className = "ratios";
  return ratios;
}

function querySection(): HTMLElement[] {
  const rows = entries("/queries");
  if (rows.length === 0) return [];
  return [
    section(
      "Sphere queries at random places, every index",
      lead(
        "Median / 99 % / 99.9 %. Candidates: what the index does alone. Answer: the triangles within " +
          "the ball, by the engine’s kernel for each candidate where the index does not know by " +
          "itself; beside it by the least code that decides the same. All answers are the same.",
      ),
      scrolled(table(rows, queryColumns)),
    ),
  ];
}

/** A bin of a histogram: from where to where, how many are in it, and of a million how many are not below. */
interface Bin {
  readonly from: string;
  readonly low: number;
  readonly high: number;
  readonly count: number;
  readonly longer: number;
  readonly series: string;
}

const looks: ReadonlyMap<string, Look> = new Map([
  ["empty loop", { color: "var(--series-7)", symbol: "square" }],
  ["certified step", { color: "var(--series-0)", symbol: "circle" }],
]);

/** Bins are an eighth of a doubling wide. Times in µs. */
function binsOf(from: string, series: string): Bin[] {
  const pairs = entries(`${from}/bins`).map((bin) => ({
    bin,
    pair: valueAt(bin) as readonly [number, number],
  }));
  let left = valueAt<number>(`${from}/total`) ?? 0;
  const total = left;
  return pairs.map(({ bin, pair: [begin, count] }) => {
    const longer = (1e6 * left) / total;
    left -= count;
    const width = 2 ** Math.floor(Math.log2(begin)) / 8;
    return { from: bin, low: begin / 1e3, high: (begin + width) / 1e3, count, longer, series };
  });
}

function histogramSection(): HTMLElement[] {
  const from = "/histogram/steps";
  if (!valueAt(from)) return [];
  const bins = [...binsOf("/histogram/nothing", "empty loop"), ...binsOf(from, "certified step")];
  const legend = new Legend(looks);
  const at = (key: string) => shown(`${from}/at_most_ns/${key}`, nanoseconds);
  return [
    section(
      "Cycle after cycle",
      lead(
        shown(`${from}/total`, grouped),
        " certified steps in contact: 99 % within ",
        at("p99"),
        ", 99.9 % within ",
        at("p999"),
        ", 99.999 % within ",
        at("p99999"),
        ", the longest ",
        shown(`${from}/longest_ns`, nanoseconds),
        ". The empty loop waits as often and as long as the median step and does nothing: its " +
          "longest took ",
        shown("/histogram/nothing/longest_ns", nanoseconds),
        ", which is the machine’s doing.",
      ),
      legend.element,
      make(
        "div",
        { class: "panels wide charts", style: "--columns:2" },
        histogramPanel("How many took how long", "cycles in a bin", bins, legend, "count"),
        histogramPanel(
          "How many took longer",
          "of a million cycles, longer",
          bins,
          legend,
          "longer",
        ),
      ),
    ),
  ];
}

function histogramPanel(
  title: string,
  label: string,
  bins: readonly Bin[],
  legend: Legend,
  height: "count" | "longer",
): HTMLElement {
  const color = ({ series }: Bin) => legend.look(series).color;
  const x = logarithmic(
    "time [µs]",
    bins.flatMap(({ low, high }) => [low, high]),
  );
  const least = height === "count" ? 0.5 : Math.min(...bins.map(({ longer }) => longer));
  const y = logarithmic(label, [least, ...bins.map((bin) => bin[height])]);
  const draw = () => {
    const seen = bins.filter(({ series }) => legend.shows(series));
    const shape =
      height === "count"
        ? Plot.rect(seen, {
            x1: "low",
            x2: "high",
            y1: () => least,
            y2: "count",
            fill: color,
            fillOpacity: 0.45,
            stroke: color,
          })
        : Plot.line(seen, { x: "low", y: "longer", z: "series", stroke: color, strokeWidth: 2 });
    const pointed = Plot.pointer({
      x: "low",
      y: height,
      r: 6,
      stroke: "var(--ink)",
      strokeWidth: 2,
    });
    return { height: 400, marginLeft: 52, inset: 7, x, y, marks: [shape, Plot.dot(seen, pointed)] };
  };
  const tip = (bin: Bin) =>
    tipOf(
      [bin.series],
      [
        ["from", shown(`${bin.from}/0`, nanoseconds)],
        ["cycles", shown(`${bin.from}/1`, grouped)],
      ],
    );
  const caption = make("figcaption", {}, make("span", { class: "name" }, title));
  return make(
    "figure",
    { class: "measured" },
    caption,
    chart({ description: title, legend, draw, tip }),
  );
}
