// SPDX-License-Identifier: BSD-3-Clause

import * as Plot from "@observablehq/plot";
import { drawn, make } from "../page/elements.ts";
import {
  chart,
  Legend,
  type Look,
  levelLine,
  levelMarks,
  levelName,
  logarithmic,
  onCard,
  tickText,
  tipOf,
} from "./charts.ts";
import { extremes } from "./extremes.ts";
import { valueAt } from "./record.ts";
import { panels } from "./report_page.ts";
import { ordinal, runColor } from "./runs.ts";
import { deep, microseconds, millimetres, show, shown } from "./shown.ts";
import {
  bestRun,
  type Moment,
  type Run,
  type SimulationRecord,
  type Stroke,
} from "./simulation_record.ts";

/** A cycle in a plot: the drawn values, and their pointer in the record. */
interface Point extends Moment {
  readonly x: number;
  readonly y: number;
}

/** The names of runs, which can be unticked. */
function legendOf(runs: Iterable<number>): Legend {
  const looks = [...runs].map((run): [string, Look] => [
    String(run),
    { color: `var(${runColor(run)})`, symbol: "circle" },
  ]);
  return new Legend(new Map(looks), (run) => shown(`/runs/${run}/name`));
}

/** The certified rule is a strong line, in front of thin and pale lines of the other runs. */
const isStrong = (run: number): boolean => run === bestRun(valueAt<readonly Run[]>("/runs") ?? []);

/** Lines of points, one for each run. */
const lines = (points: readonly Point[]): Plot.Markish[] => [
  ...[false, true].map((strong) =>
    Plot.line(
      points.filter(({ run }) => isStrong(run) === strong),
      {
        x: "x",
        y: "y",
        z: "run",
        stroke: ({ run }: Point) => `var(${runColor(run)})`,
        strokeWidth: strong ? 3.5 : 1.8,
        strokeOpacity: strong ? 1 : 0.75,
        clip: true,
      },
    ),
  ),
  Plot.dot([...points], {
    ...Plot.pointer({ x: "x", y: "y", maxRadius: 30 }),
    fill: ({ run }: Point) => `var(${runColor(run)})`,
    r: 4,
  }),
];

/** Shows a depth. That of a convex tool is a lower bound: its clearance ends at minus its radius. */
export function showDepth<Shown extends Element>(
  element: Shown,
  { has_convex_tool }: SimulationRecord,
  from: string,
): Shown {
  if (!has_convex_tool) return show(element, from, deep);
  element.append("at least ", show(element.cloneNode() as Shown, from, deep));
  return element;
}

/** Returns a clearance; below zero, the depth for a convex tool. */
export const shownClearance = (record: SimulationRecord, from: string): HTMLSpanElement =>
  record.has_convex_tool && Number(valueAt(from)) < 0
    ? showDepth(make("span"), record, from)
    : shown(from, millimetres);

/** Returns the name of the clearance: of the tip, or of a whole convex tool. */
const wordsOf = ({ has_convex_tool, mesh }: SimulationRecord) =>
  has_convex_tool
    ? {
        clearance: "tool to surface",
        below: `touching${mesh.surface === "closed" ? " or inside" : ""}, at least this deep`,
        description:
          "Distance of the whole tool to the surface over the time of one stroke, for each rule; below zero the tool touches the surface or is inside, at least as deep as drawn.",
      }
    : {
        clearance: "tip to surface",
        below: mesh.surface === "closed" ? "inside the anatomy" : null,
        description:
          "Distance of the tool tip to the surface over the time of one stroke, for each rule; below zero the tip is inside the anatomy.",
      };

/**
 * Plots the distance of the tool from the surface over the time of a stroke: all of it, and near
 * the surface.
 */
export function clearanceCharts(record: SimulationRecord, stroke: number) {
  const legend = legendOf(record.runs.keys());
  const points = record.runs.flatMap(({ strokes }, run) =>
    (strokes[stroke] as Stroke).clearance_mm.map(
      (y, cycle): Point => ({ run, stroke, cycle, x: cycle * record.cycle_s, y }),
    ),
  );
  const rules: ((cycle: number) => void)[] = [];
  let time = 0;
  const timeRule = () => {
    const line = drawn("line", { class: "now" });
    return (
      _: unknown,
      { x }: Plot.ScaleFunctions,
      __: unknown,
      { height, marginTop, marginBottom }: Plot.Dimensions,
    ) => {
      line.setAttribute("y1", String(marginTop));
      line.setAttribute("y2", String(height - marginBottom));
      const rule = (cycle: number) => {
        const at = String(x?.(cycle * record.cycle_s));
        line.setAttribute("x1", at);
        line.setAttribute("x2", at);
      };
      rules.push(rule);
      rule(time);
      return line;
    };
  };
  const words = wordsOf(record);
  /** The cycles that end a move through an open surface, which has no depth. */
  const crossings = (points: readonly Point[]): Plot.Markish[] => {
    if (record.has_convex_tool || record.mesh.surface === "closed") return [];
    const seen = points.filter(({ run, cycle }) =>
      record.runs[run]?.crossings.some((one) => one.stroke === stroke && one.cycle === cycle),
    );
    return [
      Plot.dot(seen, {
        x: "x",
        y: "y",
        symbol: "times",
        r: 7,
        stroke: "var(--alarm)",
        strokeWidth: 3,
      }),
      Plot.text(seen.length > 0 ? ["× through the surface"] : [], {
        ...{ frameAnchor: "top", dy: 4, ...onCard, fill: "var(--alarm)" },
      }),
    ];
  };
  const nameOf = (y: number, text: string, dy = -8) =>
    levelName("y", y, text, { frameAnchor: "right", dy, textAnchor: "end" });
  const draw = (domain: readonly [number, number], kept: number) => (): Plot.PlotOptions => ({
    height: 340,
    marginLeft: 52,
    x: { label: "time [s]", domain: extremes(points.map(({ x }) => x)), grid: true },
    y: { label: `${words.clearance} [mm]`, domain, grid: true },
    marks: [
      ...(words.below && domain[0] < 0
        ? [
            Plot.rectY([0], {
              y1: domain[0],
              y2: 0,
              inset: -7,
              insetTop: 0,
              fill: "var(--alarm)",
              fillOpacity: 0.08,
            }),
            Plot.text([words.below], {
              ...{ frameAnchor: "bottom-left", dx: 8, dy: -8, fill: "var(--alarm)" },
            }),
          ]
        : []),
      Plot.ruleY(kept > 0 ? [0, kept] : [0], levelLine),
      ...lines(points.filter(({ run }) => legend.shows(String(run)))),
      ...crossings(points.filter(({ run }) => legend.shows(String(run)))),
      nameOf(0, "surface", kept > 0 ? 10 : -8),
      ...(kept > 0 ? [nameOf(kept, "required clearance")] : []),
      timeRule(),
    ],
  });
  const tip = ({ run, cycle }: Point) => {
    const from = `/runs/${run}/strokes/${stroke}`;
    return tipOf(
      [shown(`/runs/${run}/name`)],
      [
        ["cycle", ordinal(`${from}/tip/${cycle}`)],
        [words.clearance, shownClearance(record, `${from}/clearance_mm/${cycle}`)],
      ],
    );
  };
  const heights = points.map(({ y }) => y);
  const [low, high] = extremes([0, ...heights]);
  const room = 0.06 * (high - low);
  const guarded = record.runs.flatMap(({ rule, strokes }) =>
    rule === "none" ? [] : [extremes((strokes[stroke] as Stroke).clearance_mm)[0]],
  );
  const deepest = Math.min(0, ...guarded);
  // If no rule failed, shows only a small range around the surface.
  const around = Math.max(-deepest, ...guarded, record.kept_mm, deepest === 0 ? 0.1 : 0);
  const both = [
    [words.description, draw([low - room, high + room], 0)],
    [
      "The same distances, enlarged around the surface.",
      draw([deepest - 0.5 * around, 2.5 * around], record.kept_mm),
    ],
  ] as const;
  const figures = both.map(([description, drawing]) =>
    chart({ description, draw: drawing, tip, legend }),
  );
  return {
    elements: [make("h3", {}, "How near it came"), legend.element, panels(...figures)],
    follow(cycle: number): void {
      time = cycle;
      for (const rule of rules) rule(cycle);
    },
  };
}

/**
 * Plots for each rule the fraction of steps that took at least a given time; empty without times.
 */
export function stepTimes(record: SimulationRecord): HTMLElement[] {
  const points = record.runs.flatMap(({ strokes }, run) => {
    const steps = strokes.flatMap(({ step_us }, stroke) =>
      step_us.flatMap((us, cycle) => (us > 0 ? [{ us, stroke, cycle }] : [])),
    );
    steps.sort((a, b) => a.us - b.us);
    return steps.flatMap(({ us, stroke, cycle }, i): Point[] => {
      const isSeen =
        i + 1 === steps.length || i === 0 || column(us) !== column(steps[i - 1]?.us ?? 0);
      return isSeen
        ? [{ run, stroke, cycle, x: us, y: (100 * (steps.length - i)) / steps.length }]
        : [];
    });
  });
  if (points.length === 0) return [];
  const legend = legendOf(new Set(points.map(({ run }) => run)));
  const cycle = 1e6 * record.cycle_s;
  const times = [...points.map(({ x }) => x), 1.3 * cycle];
  const draw = (): Plot.PlotOptions => ({
    height: 340,
    marginLeft: 60,
    marginTop: 28,
    x: logarithmic("time of a step [µs]", times),
    y: {
      ...logarithmic(
        "steps at least as slow",
        points.map(({ y }) => y),
      ),
      tickFormat: (share: number) => `${tickText(share)} %`,
    },
    marks: [
      ...lines(points.filter(({ run }) => legend.shows(String(run)))),
      ...levelMarks("x", cycle, "one control cycle", {
        ...{ frameAnchor: "top", dx: -8, dy: 6, textAnchor: "end" },
      }),
    ],
  });
  const tip = ({ run, stroke, cycle }: Point) =>
    tipOf(
      [shown(`/runs/${run}/name`)],
      [
        [
          "time of the step",
          shown(`/runs/${run}/strokes/${stroke}/step_us/${cycle}`, microseconds),
        ],
        ["stroke", ordinal(`/runs/${run}/strokes/${stroke}`)],
        ["cycle", ordinal(`/runs/${run}/strokes/${stroke}/tip/${cycle}`)],
      ],
    );
  const description = "For each rule, the part of all steps that took at least so long.";
  return [legend.element, chart({ description, draw, tip, legend })];
}

/** Times that are drawn as one. */
const column = (us: number): number => Math.floor(80 * Math.log10(us));
