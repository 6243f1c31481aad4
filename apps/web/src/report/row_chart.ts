// SPDX-License-Identifier: BSD-3-Clause
import * as Plot from "@observablehq/plot";
import { drawn } from "../page/elements.ts";
import { type Chart, chart, onCard } from "./charts.ts";
import { type Format, show } from "./shown.ts";

/** A value of the record within a text of a plot. */
export interface Inscribed {
  readonly from: string;
  readonly format?: Format;
}
type Inscription<Datum> = (datum: Datum) => readonly (Inscribed | string)[];

/** The channels of the marks of a row chart. */
interface RowChannels<Datum> {
  readonly y: (datum: Datum, place: number) => number;
  readonly color: (datum: Datum) => string;
  readonly symbol: (datum: Datum) => string;
}

/** A chart with one row per datum, with the name above on the left and the value on the right. */
interface RowChart<Datum> extends Omit<Chart<Datum>, "draw"> {
  /** In the order of the rows; called for each drawing. */
  readonly data: () => readonly Datum[];
  /** The series of a datum in the legend; if missing, all are shown. */
  readonly series?: (datum: Datum) => string;
  readonly name: Inscription<Datum>;
  readonly value: Inscription<Datum>;
  readonly x: (data: readonly Datum[]) => Plot.ScaleOptions;
  readonly marks: (seen: Datum[], channels: RowChannels<Datum>) => readonly Plot.Markish[];
}

const rowHeight = 42;
/** The position of a mark or a bar in its row: below the texts. */
export const inRow = { dy: 9 };
export const barInRow = { insetTop: 22, insetBottom: 7 };
/** The part of a row that its texts leave to a line. */
export const belowTexts = { insetTop: 20, insetBottom: 0 };

/** True if the rows do not fit a screen, so that the plot has an axis on top too. */
export const isLong = (rows: readonly unknown[]): boolean => rows.length > 12;

/** Returns a line in each row from one value to another, and a mark at the first. */
export function spans<Datum>(
  seen: Datum[],
  { y, color, symbol }: RowChannels<Datum>,
  from: (datum: Datum) => number,
  to: (datum: Datum) => number,
): Plot.Markish[] {
  const line = { stroke: color, strokeWidth: 2, y1: y, y2: y };
  return [
    Plot.link(seen, { x1: from, x2: to, ...inRow, ...line }),
    Plot.dot(seen, { x: from, y, ...inRow, symbol, fill: color, r: 5 }),
  ];
}

/** Returns the element with a row chart. */
export function rowChart<Datum>(wanted: RowChart<Datum>): HTMLElement {
  const { data, series = () => "", legend, name, value, x, marks } = wanted;
  const y = (_: Datum, place: number) => place;
  const look = (datum: Datum) => legend?.look(series(datum));
  const channels: RowChannels<Datum> = {
    y,
    color: (datum) => look(datum)?.color ?? "var(--ink)",
    symbol: (datum) => (look(datum)?.symbol ?? "circle") as string,
  };
  const text = { y, dy: -9, fontSize: 13, ...onCard };
  const band = { stroke: "var(--ink)", strokeOpacity: 0.06, strokeWidth: rowHeight };
  const draw = () => {
    const all = data();
    const seen = all.filter((datum) => legend?.shows(series(datum)) ?? true);
    const [axis, marginTop] = isLong(seen) ? (["both", 46] as const) : (["bottom", 4] as const);
    return {
      height: rowHeight * seen.length + 42 + marginTop,
      inset: 0,
      marginTop,
      marginLeft: 14,
      marginRight: 14,
      x: { ...x(all), inset: 7, axis },
      y: { type: "band", domain: seen.map(y), axis: null, padding: 0 } as const,
      marks: [
        Plot.ruleY(seen, Plot.pointerY({ y, maxRadius: rowHeight, ...band })),
        ...marks(seen, channels),
        inscribed(seen, name, { ...text, frameAnchor: "left", dx: 6 }),
        inscribed(seen, value, { ...text, frameAnchor: "right", dx: -6, fontWeight: 600 }),
      ],
    };
  };
  return chart({ ...wanted, draw });
}

/** Returns a mark of texts with values of the record; each text states the pointer to its value. */
function inscribed<Datum>(data: Datum[], content: Inscription<Datum>, options: Plot.TextOptions) {
  return Plot.text(data, {
    ...options,
    text: () => " ",
    render: (index, scales, values, dimensions, context, next) => {
      const group = next?.(index, scales, values, dimensions, context) ?? null;
      group?.querySelectorAll("text").forEach((text, i) => {
        const parts = content(data[index[i] as number] as Datum).map((part) => {
          if (typeof part === "string") return drawn("tspan", {}, part);
          return show(drawn("tspan"), part.from, part.format);
        });
        text.replaceChildren(...parts);
      });
      return group;
    },
  });
}
