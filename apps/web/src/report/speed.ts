// SPDX-License-Identifier: BSD-3-Clause
/** The sections of the ratios that the speed test requires of keepout. */

import * as Plot from "@observablehq/plot";
import { make } from "../page/elements.ts";
import { chart, Legend, type Look, logarithmic, plotSection, tipOfColumns } from "./charts.ts";
import { curves } from "./curves.ts";
import { entries, type Timing, valueAt } from "./record.ts";
import { type Format, mean, nanoseconds, rounded, shown, trimmed } from "./shown.ts";
import { type Column, column, tableSection } from "./table.ts";

/** Returns median, 99 % and 99.9 % in one unit, as far as there are enough samples. */
function percentiles(from: string): (Node | string)[] {
  const timing = valueAt<Timing>(from);
  if (!timing) return ["–"];
  const isLong = timing.p50 >= 1e4;
  const unit = isLong ? "ms" : "µs";
  const format: Format = (us) => rounded(isLong ? us / 1e3 : us);
  const times = (["p50", "p99", "p999"] as const).filter((key) => timing[key] !== null);
  return [
    ...times.flatMap((key, i) => {
      const time = shown(`${from}/${key}`, format);
      time.dataset.unit = unit; // which follows the last of them
      return [i > 0 ? " / " : "", time];
    }),
    `\u00a0${unit}`,
  ];
}

/** Returns the unit of a value of a row. */
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
  column("Triangles found", "/found_mean", mean),
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

/** Returns the sections: ratios, the histogram of many steps, and queries. */
export function speedSections(): HTMLElement[] {
  return [ratioSection(), ...histogramSection(), ...querySection()];
}

function ratioSection(): HTMLElement {
  const ratios = tableSection(
    "What is demanded, and what was measured",
    [
      "Of ",
      shown("/mesh"),
      " unless said, on one core unless said. Beside each figure what it is made of: median / 99 % / 99.9 %. A median of a fraction of a microsecond, marked *, is that of batches; reading the clock, which all other times include, takes ",
      shown("/machine/clock_ns", (ns) => `${rounded(ns, 2)}\u00a0ns`),
      ".",
    ],
    entries("/rows"),
    ratioColumns,
  );
  ratios.className = "ratios";
  return ratios;
}

function querySection(): HTMLElement[] {
  const rows = entries("/queries");
  if (rows.length === 0) return [];
  return [
    tableSection(
      "Sphere queries at random places, every index",
      [
        "Median / 99 % / 99.9 %. Candidates: what the index does alone. Answer: the triangles within the ball, by the engine’s kernel for each candidate where the index does not know by itself; beside it by the least code that decides the same. All answers are the same.",
      ],
      rows,
      queryColumns,
    ),
  ];
}

/** A bin of a histogram, in µs: its count, and how many of a million are not below it. */
interface Bin {
  readonly from: string;
  readonly low: number;
  readonly high: number;
  readonly count: number;
  readonly longer: number;
  readonly series: string;
}

/** A bin is an eighth of an octave wide. */
function binsOf(from: string, series: string): Bin[] {
  const total = valueAt<number>(`${from}/total`) ?? 0;
  let left = total;
  return entries(`${from}/bins`).map((bin) => {
    const [begin, count] = valueAt(bin) as readonly [number, number];
    const longer = (1e6 * left) / total;
    left -= count;
    const high = begin + 2 ** Math.floor(Math.log2(begin)) / 8;
    return { from: bin, low: begin / 1e3, high: high / 1e3, count, longer, series };
  });
}

const looks: ReadonlyMap<string, Look> = new Map([
  ["empty loop", { color: "var(--series-7)", symbol: "square" }],
  ["certified step", { color: "var(--series-0)", symbol: "circle" }],
]);
const binColumns: readonly Column[] = [column("from", "/0", nanoseconds), column("cycles", "/1")];

function histogramSection(): HTMLElement[] {
  const from = "/histogram/steps";
  if (!valueAt(from)) return [];
  const legend = new Legend(looks);
  const bins = [...binsOf("/histogram/nothing", "empty loop"), ...binsOf(from, "certified step")];
  const tip = (bin: Bin) => tipOfColumns([bin.series], bin.from, binColumns);
  const color = ({ series }: Bin) => legend.look(series).color;
  const counts = chart({
    title: "How many took how long",
    description: "How many cycles took how long: certified steps, and an empty loop",
    legend,
    tip,
    draw: () => {
      const seen = bins.filter(({ series }) => legend.shows(series));
      const place = { x1: "low", x2: "high", y1: () => 0.5, y2: "count" };
      const pointed = Plot.pointerX({ ...place, stroke: "var(--ink)", strokeWidth: 2 });
      return {
        height: 420,
        x: logarithmic(
          "time [µs]",
          bins.flatMap(({ low, high }) => [low, high]),
        ),
        y: logarithmic("cycles in a bin", [0.5, ...bins.map(({ count }) => count)]),
        marks: [
          Plot.rect(seen, { ...place, fill: color, fillOpacity: 0.45, stroke: color }),
          Plot.rect(seen, pointed),
        ],
      };
    },
  });
  const tails = curves({
    title: "How many took longer",
    description: "How many of a million cycles took longer: certified steps, and an empty loop",
    data: () => bins,
    series: ({ series }) => series,
    x: ["time [µs]", ({ low }) => low],
    y: ["of a million cycles, longer", ({ longer }) => longer],
    legend,
    tip,
  });
  return [
    plotSection(
      "Cycle after cycle",
      ["The empty loop waits as often and as long as the median step, and does nothing."],
      legend,
      counts,
      tails,
    ),
  ];
}
