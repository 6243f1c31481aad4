// SPDX-License-Identifier: BSD-3-Clause
/** The common parts of all plots: responsive drawing, tips, and filtering by a legend. */

import * as Plot from "@observablehq/plot";
import { make } from "../page/elements.ts";
import { extremes } from "./extremes.ts";
import { lead, panels, section } from "./report_page.ts";
import { shown } from "./shown.ts";
import type { Column } from "./table.ts";

/** The appearance of a series: its color and its mark. */
export interface Look {
  readonly color: string;
  readonly symbol: Plot.SymbolType;
}

const symbols = ["circle", "square", "triangle", "diamond", "cross", "wye"] as const;

/** Returns the appearance of series by name, which is the same in all plots. */
export function looksOf(names: readonly string[]): Map<string, Look> {
  return new Map(
    [...new Set(names)].map((name, i) => [
      name,
      { color: `var(--series-${i % 10})`, symbol: symbols[i % symbols.length] ?? "circle" },
    ]),
  );
}

/** Choices of the reader that affect the charts. */
export class Choices {
  private readonly listeners: (() => void)[] = [];

  whenChanged(listener: () => void): void {
    this.listeners.push(listener);
  }
  protected changed(): void {
    for (const listener of this.listeners) listener();
  }
}

/** Names of series with their looks. Its charts omit series that are not ticked. */
export class Legend extends Choices {
  readonly element = make(
    "fieldset",
    { class: "legend" },
    make("legend", { class: "unseen" }, "Shown"),
  );
  private readonly hidden = new Set<string>();

  /**
   * `label`: the displayed name, if it differs. `others`: further choices that its charts follow.
   */
  constructor(
    readonly looks: ReadonlyMap<string, Look>,
    label: (name: string) => Node | string = (name) => name,
    others?: Choices,
  ) {
    super();
    others?.whenChanged(() => this.changed());
    for (const [name, look] of looks) {
      const tick = make("input", { type: "checkbox", checked: "" });
      tick.addEventListener("change", () => {
        if (tick.checked) this.hidden.delete(name);
        else this.hidden.add(name);
        this.changed();
      });
      this.element.append(make("label", {}, tick, glyph(look), label(name)));
    }
  }

  shows = (name: string): boolean => !this.hidden.has(name);
  look = (name: string): Look => this.looks.get(name) ?? { color: "var(--ink)", symbol: "star" };
}

function glyph({ color, symbol }: Look): Element {
  const mark = Plot.dot([0], { frameAnchor: "middle", symbol, fill: color, r: 5 });
  const picture = Plot.plot({ width: 14, height: 14, margin: 0, marks: [mark] });
  picture.setAttribute("aria-hidden", "true");
  return picture;
}

/** A card with a plot of data, in the width of its container. */
export interface Chart<Datum> {
  readonly title?: string;
  /** For readers who cannot see it. */
  readonly description: string;
  readonly draw: (width: number) => Plot.PlotOptions;
  /** The tip of a datum under the pointer: see the marks that are made with Plot.pointer. */
  readonly tip: (datum: Datum) => readonly (Node | string)[];
  readonly legend?: Legend;
}

/** Space around a plot, for its axes. */
const space = { marginLeft: 48, marginBottom: 40, inset: 7 };

/** Returns the element with a chart. */
export function chart<Datum>(wanted: Chart<Datum>): HTMLElement {
  const { title, description, draw, tip, legend } = wanted;
  const bubble = make("div", { class: "tip", hidden: "" });
  const place = make("div", { class: "plot", role: "img", "aria-label": description });
  let width = 0;
  const redraw = () => {
    const picture = Plot.plot({ ...space, ...draw(width), width, className: "drawing" });
    picture.setAttribute("aria-hidden", "true");
    picture.addEventListener("input", () => {
      const datum = picture.value as Datum | null;
      bubble.hidden = datum === null;
      if (datum !== null) bubble.replaceChildren(...tip(datum));
    });
    place.replaceChildren(picture, bubble);
  };
  const follow = (event: PointerEvent) => {
    const { left, top, width: room } = place.getBoundingClientRect();
    const x = event.clientX - left;
    bubble.style.top = `${event.clientY - top + 16}px`;
    bubble.style.left = `${Math.max(0, Math.min(x + 12, room - bubble.offsetWidth - 4))}px`;
  };
  place.addEventListener("pointermove", follow);
  place.addEventListener("pointerdown", follow);
  legend?.whenChanged(redraw);
  // A hidden chart has no width, but is drawn for print.
  new ResizeObserver(([entry]) => {
    const room = Math.floor(entry?.contentRect.width ?? 0) || width || 560;
    if (room === width) return;
    width = room;
    redraw();
  }).observe(place);
  const name = title && make("figcaption", {}, make("span", { class: "name" }, title));
  return make("figure", {}, ...(name ? [name] : []), place);
}

/**
 * Returns a section with plots side by side, which a legend filters. `words`: their explanation.
 */
export const plotSection = (
  title: string,
  words: readonly (Node | string)[],
  legend: Legend,
  ...plots: readonly HTMLElement[]
): HTMLElement => section(title, lead(...words), legend.element, panels(...plots));

/** Returns names and values for a tip. */
export function tipOf(
  title: readonly (Node | string)[],
  facts: readonly (readonly [string, Node])[],
): HTMLElement[] {
  const lines = facts.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]);
  return [make("b", {}, ...title), make("dl", {}, ...lines)];
}

/** Like tipOf(), for the values that some columns of a table show. */
export const tipOfColumns = (
  title: readonly (Node | string)[],
  row: string,
  columns: readonly Column[],
): HTMLElement[] =>
  tipOf(
    title,
    columns.map(({ heading, from, format }) => [heading, shown(row + from, format)]),
  );

/** The look of a dashed line at a value that matters. */
export const levelLine = { stroke: "var(--soft)", strokeDasharray: "5 4" };

/** A background of a text in the color of the card, so that no line strikes through it. */
export const onCard = { fill: "currentColor", stroke: "var(--card)", strokeWidth: 3 };

/** Returns the name of a value of one axis that matters. */
export const levelName = (axis: "x" | "y", level: number, name: string, place: Plot.TextOptions) =>
  Plot.text([name], { [axis]: level, ...onCard, fill: levelLine.stroke, ...place });

/** Returns a dashed line across the plot at a value of one axis, with its name. */
export function levelMarks(
  axis: "x" | "y",
  level: number,
  name: string,
  place: Plot.TextOptions,
): Plot.Markish[] {
  const line = axis === "x" ? Plot.ruleX : Plot.ruleY;
  return [line([level], levelLine), levelName(axis, level, name, place)];
}

/** Returns a logarithmic scale with ticks that fit the values. */
export function logarithmic(label: string | null, values: readonly number[]): Plot.ScaleOptions {
  const positive = values.filter((value) => value > 0);
  const [low, high] = extremes(positive);
  const decades = Math.log10(high / low);
  const digits = decades > 2 ? [1] : decades > 0.6 ? [1, 2, 5] : [1, 2, 3, 4, 5, 6, 7, 8, 9];
  const ticks = [];
  const step = Math.max(1, Math.ceil(decades / 8));
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    if (power % step !== 0) continue;
    for (const digit of digits) ticks.push(digit * 10 ** power);
  }
  const seen = ticks.filter((tick) => tick >= low && tick <= high);
  return { type: "log", domain: [low, high], label, grid: true, ticks: seen, tickFormat: tickText };
}

/** Returns the text of a tick: −0.5, 200, 50k, 1M, 10⁻⁶. */
export function tickText(value: number): string {
  if (value < 0) return `−${tickText(-value)}`;
  if (value >= 1e6) return `${Number((value / 1e6).toPrecision(6))}M`;
  if (value >= 1e4) return `${Number((value / 1e3).toPrecision(6))}k`;
  if (value >= 0.9e-3 || value === 0) return String(Number(value.toPrecision(6)));
  const [digit, power] = value.toExponential(0).split("e-") as [string, string];
  const raised = [...power].map((one) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(one)]).join("");
  return `${digit === "1" ? "" : `${digit}·`}10⁻${raised}`;
}
