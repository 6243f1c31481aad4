// SPDX-License-Identifier: BSD-3-Clause
import * as Plot from "@observablehq/plot";
import { type Chart, chart, type Legend, levelMarks, logarithmic } from "./charts.ts";

/** A plot of lines through marks, one line for each series, on two logarithmic axes. */
interface Curves<Datum> extends Omit<Chart<Datum>, "draw"> {
  /** Called for each drawing. */
  readonly data: () => readonly Datum[];
  readonly series: (datum: Datum) => string;
  /** The label of an axis, and the value of a datum on it; NaN: not drawn. */
  readonly x: readonly [string, (datum: Datum) => number];
  readonly y: readonly [string, (datum: Datum) => number];
  readonly legend: Legend;
  /** A reference value and its name. */
  readonly rule?: readonly [number, string];
  /** True for marks without lines, if a series has several at one place. */
  readonly isLoose?: boolean;
}

/** Returns the element with such a plot. Stars have no lines. */
export function curves<Datum>(wanted: Curves<Datum>): HTMLElement {
  const { legend, series, rule, isLoose = false } = wanted;
  const [[xLabel, x], [yLabel, y]] = [wanted.x, wanted.y];
  const fill = (datum: Datum) => legend.look(series(datum)).color;
  const symbol = (datum: Datum) => legend.look(series(datum)).symbol as string;
  const r = (datum: Datum) => (symbol(datum) === "star" ? 7 : 4.5);
  const draw = () => {
    const data = wanted
      .data()
      .filter((datum) => x(datum) > 0 && y(datum) > 0)
      .sort((a, b) => x(a) - x(b));
    const seen = data.filter((datum) => legend.shows(series(datum)));
    const joined = seen.filter((datum) => !isLoose && symbol(datum) !== "star");
    return {
      height: 420,
      r: { type: "identity" } as const,
      x: logarithmic(xLabel, data.map(x)),
      y: logarithmic(yLabel, [...data.map(y), ...(rule ? [rule[0]] : [])]),
      marks: [
        ...(rule ? levelMarks("y", ...rule, { frameAnchor: "left", dx: 4, dy: -8 }) : []),
        Plot.line(joined, { x, y, z: series, stroke: fill, strokeWidth: 2 }),
        Plot.dot(seen, { x, y, symbol, fill, stroke: "var(--card)", r }),
        Plot.dot(seen, Plot.pointer({ x, y, stroke: "var(--ink)", strokeWidth: 2, r: 9 })),
      ],
    };
  };
  return chart({ ...wanted, draw });
}
