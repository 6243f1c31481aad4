// SPDX-License-Identifier: BSD-3-Clause
/** The appearance of runs on a page: their names, with a swatch of their colors. */
import { make } from "../page/elements.ts";
import { lastKey, valueAt } from "./record.ts";
import { shown } from "./shown.ts";

/**
 * Returns the variable of the page's style with the color of a rule, a mode or a checker. Those
 * without a color of their own in rule_colors.css, such as checkers by samples, share one.
 */
export function ruleColor(rule: string): string {
  const own = `--rule-${rule.replaceAll(" ", "_").replace("linearised", "linearized")}`;
  const isKnown = getComputedStyle(document.documentElement).getPropertyValue(own) !== "";
  return isKnown ? own : "--rule-sampled";
}

/** Returns a swatch of a color, before a name. */
export const swatched = (color: string, ...name: readonly (Node | string)[]): HTMLElement =>
  make(
    "span",
    { class: "name", style: `--color: var(${color})` },
    make("span", { class: "swatch" }),
    ...name,
  );

/** Returns the color of a run of a simulation. */
export const runColor = (run: number): string => ruleColor(valueAt(`/runs/${run}/rule`) ?? "");

/** Returns the name of a run of a simulation, after a swatch of its color. */
export const runName = (run: number): HTMLElement =>
  swatched(runColor(run), shown(`/runs/${run}/name`));

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
