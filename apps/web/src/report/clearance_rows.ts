// SPDX-License-Identifier: BSD-3-Clause
/** A plot of the clearances that were left, with a row for each checker or mesh. */
import * as Plot from "@observablehq/plot";
import { levelLine, levelName, tickText } from "./charts.ts";
import { extremes } from "./extremes.ts";
import { valueAt } from "./record.ts";
import { belowTexts, type Inscribed, inRow, isLong, rowChart } from "./row_chart.ts";

/** A row, by its pointer, and the values that it shows as dots. */
export interface ClearanceRow {
  readonly from: string;
  readonly color: string;
  readonly dots: readonly Dot[];
}

/** A clearance; `isBad`: it is less than required. */
interface Dot {
  readonly x: number;
  readonly isBad: boolean;
}

/** Returns the dot of a value of the record; nothing if it is missing. */
export function dotAt(from: string, isBad: (value: number) => boolean): Dot[] {
  const value = valueAt<number | null>(from);
  return typeof value === "number" ? [{ x: value, isBad: isBad(value) }] : [];
}

/** Returns the plot. `levels`: values of the axis that matter, with their names. */
export function clearanceRows(wanted: {
  readonly title: string;
  readonly description: string;
  readonly label: string;
  readonly rows: readonly ClearanceRow[];
  readonly levels: readonly (readonly [number, string])[];
  readonly name: (row: ClearanceRow) => readonly (Inscribed | string)[];
  readonly value: (row: ClearanceRow) => readonly (Inscribed | string)[];
  readonly tip: (row: ClearanceRow) => readonly (Node | string)[];
}): HTMLElement {
  const { rows, levels, label } = wanted;
  const at = levels.map(([level]) => level);
  const [low, high] = extremes([...at, ...rows.flatMap(({ dots }) => dots.map(({ x }) => x))]);
  const room = 0.04 * (high - low) || 1;
  // Values of several powers of ten on both sides of zero.
  const ticks = [...at, ...[10, 1e2, 1e3, 1e4, 1e5, 1e6].filter((tick) => tick <= high)];
  const isWide = high - low > 100;
  const scale = isWide ? { type: "symlog" as const, constant: 0.4, ticks } : {};
  const domain = isWide ? [low - 1, 1.5 * high] : [low - room, high + room];
  return rowChart({
    ...wanted,
    data: () => rows,
    x: () => ({ label, domain, grid: true, tickFormat: tickText, ...scale }),
    marks: (seen, { y }) => [
      ...levels.flatMap(([level, name]) => {
        const isLeft = level < (low + high) / 2; // the name lies on the inner side
        const place = { dx: isLeft ? 5 : -5, textAnchor: isLeft ? "start" : "end" } as const;
        return [
          // Ends below the texts of each row, which it would strike through.
          Plot.tickX(seen, { x: () => level, y, ...belowTexts, ...levelLine }),
          ...(isLong(seen) ? (["top", "bottom"] as const) : (["bottom"] as const)).map((side) =>
            levelName("x", level, name, {
              ...place,
              frameAnchor: side,
              dy: side === "top" ? -4 : 4,
            }),
          ),
        ];
      }),
      Plot.dot(
        seen.flatMap(({ dots, color }, place) => dots.map((dot) => ({ ...dot, color, place }))),
        {
          x: "x",
          y: "place",
          ...inRow,
          r: 5,
          fill: ({ color, isBad }) => (isBad ? "var(--alarm)" : color),
          fillOpacity: 0.75,
          symbol: ({ isBad }: { isBad: boolean }) => (isBad ? "times" : "circle"),
          stroke: ({ isBad }: { isBad: boolean }) => (isBad ? "var(--alarm)" : "none"),
          strokeWidth: 2.5,
        },
      ),
    ],
  });
}
