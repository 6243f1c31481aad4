// SPDX-License-Identifier: BSD-3-Clause
/** How values of the record are shown: each element says from where in the record its text is. */
import { grouped, make } from "../page/elements.ts";
import { entries, lastKey, valueAt } from "./record.ts";

/** What a number looks like. */
export type Format = (value: number) => string;

/** Significant digits, never an exponent: 1230, 12.0, 0.00123. */
export function rounded(value: number, digits = 3): string {
  if (value === 0) return "0";
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  return value.toFixed(Math.min(Math.max(digits - 1 - magnitude, 0), 9));
}

/** The same without zeros at the end: 12, 0.5. */
export const trimmed = (value: number, digits = 6): string => {
  const text = rounded(value, digits);
  return text.includes(".") ? text.replace(/\.?0+$/, "").replace(/^-0$/, "0") : text;
};

/** A mean of counts: 0.130, 26.2, 10,151. */
export const mean: Format = (value) => (value >= 1e3 ? grouped(value) : rounded(value));

/** A time that the record has in µs, in the unit that suits it. */
export const microseconds: Format = (us) =>
  us >= 1e4 ? `${rounded(us / 1e3)}\u00a0ms` : `${rounded(us)}\u00a0µs`;

/** A time that the record has in ns, in the unit that suits it. */
export const nanoseconds: Format = (ns) => microseconds(ns / 1e3);

/** A length in the unit that suits it, mm, µm or nm. */
export function millimetres(mm: number): string {
  const size = Math.abs(mm);
  if (size === 0) return "0\u00a0mm";
  if (size >= 0.01) return `${rounded(mm)}\u00a0mm`;
  if (size >= 1e-5) return `${rounded(1e3 * mm)}\u00a0µm`;
  return size >= 1e-6 ? `${rounded(1e6 * mm)}\u00a0nm` : "under\u00a01\u00a0nm";
}

/** How deep something is, by a clearance below zero: "1.50 mm deep". */
export const deep: Format = (clearance) => `${millimetres(-clearance)} deep`;

/** A share of one as a percentage without its sign. */
export const percent: Format = (share) => mean(100 * share);

/** Errors span many powers of ten: 0.0012, 3.1·10⁻¹⁴. */
export function error(value: number): string {
  if (value === 0 || Math.abs(value) >= 1e-3) return rounded(value, 2);
  const [digits, exponent] = value.toExponential(1).split("e") as [string, string];
  const raised = [...exponent].map((digit) => (digit === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(digit)]));
  return `${digits}·10${raised.join("")}`;
}

/** A number with a unit behind it. */
export const inUnit =
  (unit: string, format: Format = rounded): Format =>
  (value) =>
    `${format(value)}\u00a0${unit}`;

/** The text of a value of the record: a dash for what was not measured or has no meaning there. */
function textOf(pointer: string, format: Format = trimmed): string {
  const value = valueAt<unknown>(pointer);
  if (value === null || value === undefined || value === "") return "–";
  return typeof value === "number" ? format(value) : String(value);
}

/** Says in an element what the record has at a pointer. */
export function show<Shown extends Element>(
  element: Shown,
  pointer: string,
  format?: Format,
): Shown {
  element.setAttribute("data-from", pointer);
  element.textContent = textOf(pointer, format);
  return element;
}

/** What the record has at a pointer, for the midst of a text. */
export const shown = (pointer: string, format?: Format): HTMLSpanElement =>
  show(make("span"), pointer, format);

/** The name under which the record has what a pointer leads to. */
export function shownName(pointer: string): HTMLSpanElement {
  return make("span", { "data-from": pointer, "data-name": "" }, lastKey(pointer));
}

/** All that is at a pointer, whatever it is, in full: names and values, and lists of them. */
export function shownWhole(pointer: string): Node[] {
  const value = valueAt<unknown>(pointer);
  if (Array.isArray(value)) {
    return entries(pointer).flatMap((entry, i) => [
      ...(i > 0 ? [document.createTextNode(", ")] : []),
      ...shownWhole(entry),
    ]);
  }
  if (value === null || typeof value !== "object") return [shown(pointer, String)];
  return [make("dl", {}, ...shownMembers(pointer))];
}

/** Names and values of an object of the record, for a list of definitions. */
export const shownMembers = (pointer: string): HTMLElement[] =>
  entries(pointer).flatMap((entry) => [
    make("dt", {}, shownName(entry)),
    make("dd", {}, ...shownWhole(entry)),
  ]);

/** The paragraphs that the record has in an array of texts, or the one that it has in a text. */
export const paragraphs = (pointer: string, name: string): HTMLElement[] =>
  (Array.isArray(valueAt(pointer)) ? entries(pointer) : [pointer])
    .filter((from) => valueAt(from))
    .map((from) => show(make("p", { class: name }), from));
