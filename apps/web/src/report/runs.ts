// SPDX-License-Identifier: BSD-3-Clause
/** How runs are told apart on a page: by their names, with a swatch of their colours. */
import { make } from "../page/elements.ts";
import { lastKey } from "./record.ts";
import { shown } from "./shown.ts";

/** The variable of the page's style that has the colour of a run. */
export const runColor = (run: number): string => `--rule-${run % 6}`;

/** The name of a run, after a swatch of its colour. `from`: where the name is. */
export const runName = (run: number, from = `/runs/${run}/name`): HTMLElement =>
  make(
    "span",
    { class: "name", style: `--color: var(${runColor(run)})` },
    make("span", { class: "swatch" }),
    shown(from),
  );

/** The place of something in an array of the record, as people count: from one. */
export const ordinal = (pointer: string): HTMLElement =>
  make(
    "span",
    { "data-from": pointer, "data-ordinal": "" },
    (Number(lastKey(pointer)) + 1).toLocaleString("en"),
  );

/** A place for pictures side by side: two and four make pairs, three a row. */
export const pictureGrid = (count: number): HTMLElement =>
  make("div", {
    class: "panels",
    style: `--columns:${count === 3 || count > 4 ? 3 : Math.min(count, 2)}`,
  });
