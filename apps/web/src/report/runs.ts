// SPDX-License-Identifier: BSD-3-Clause
/** The appearance of runs on a page: their names, with a swatch of their colors. */
import { make } from "../page/elements.ts";
import { lastKey } from "./record.ts";
import { shown } from "./shown.ts";

/** Returns the variable of the page's style with the color of a run. */
export const runColor = (run: number): string => `--rule-${run % 6}`;

/** Returns the name of a run, after a swatch of its color. `from`: the pointer to the name. */
export const runName = (run: number, from = `/runs/${run}/name`): HTMLElement =>
  make(
    "span",
    { class: "name", style: `--color: var(${runColor(run)})` },
    make("span", { class: "swatch" }),
    shown(from),
  );

/** Returns the position in an array of the record, counted from one. */
export const ordinal = (pointer: string): HTMLElement =>
  make(
    "span",
    { "data-from": pointer, "data-ordinal": "" },
    (Number(lastKey(pointer)) + 1).toLocaleString("en"),
  );

/** Returns a container for pictures side by side: pairs for two or four, else three a row. */
export const pictureGrid = (count: number): HTMLElement =>
  make("div", {
    class: "panels",
    style: `--columns:${count === 3 || count > 4 ? 3 : Math.min(count, 2)}`,
  });
