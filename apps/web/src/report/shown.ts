// SPDX-License-Identifier: BSD-3-Clause
/** Texts of values of the record: each element states the pointer to its value. */
import { grouped, make, signed } from "../page/elements.ts";
import { entries, lastKey, valueAt } from "./record.ts";

/** Converts a number to text. */
export type Format = (value: number) => string;

/** Returns a number with significant digits, never with an exponent: 1230, 12.0, 0.00123. */
export function rounded(value: number, digits = 3): string {
  if (value === 0) return "0";
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  return value.toFixed(Math.min(Math.max(digits - 1 - magnitude, 0), 9));
}

/** Like rounded(), but without zeros at the end: 12, 0.5. */
export const trimmed = (value: number, digits = 6): string => {
  const text = rounded(value, digits);
  return text.includes(".") ? text.replace(/\.?0+$/, "").replace(/^-0$/, "0") : text;
};

/** A mean of counts: 0.130, 26.2, 10,151. */
export const mean: Format = (value) => (value >= 1e3 ? grouped(value) : rounded(value));

/** Returns a time, in µs in the record, in a suitable unit. */
export const microseconds: Format = (us) =>
  us >= 1e4 ? `${rounded(us / 1e3)}\u00a0ms` : `${rounded(us)}\u00a0µs`;

/** Returns a time, in ns in the record, in a suitable unit. */
export const nanoseconds: Format = (ns) => microseconds(ns / 1e3);

/** Returns a time, in s in the record, in a suitable unit. */
export const seconds: Format = (s) => {
  if (s >= 1) return `${mean(s)}\u00a0s`;
  return s >= 1e-3 ? `${rounded(1e3 * s)}\u00a0ms` : `${rounded(1e6 * s)}\u00a0µs`;
};

/** Returns a length in a suitable unit: mm, µm or nm. */
export function millimetres(mm: number): string {
  const size = Math.abs(mm);
  if (size === 0) return "0\u00a0mm";
  if (size >= 0.01) return `${rounded(mm)}\u00a0mm`;
  if (size >= 1e-5) return `${rounded(1e3 * mm)}\u00a0µm`;
  return size >= 1e-6 ? `${rounded(1e6 * mm)}\u00a0nm` : "under\u00a01\u00a0nm";
}

/** Returns the depth for a clearance below zero: "1.50 mm deep". */
export const deep: Format = (clearance) => `${millimetres(-clearance)} deep`;

/** Returns a fraction of one as a percentage without its sign. */
export const percent: Format = (share) => mean(100 * share);

/** Errors span many powers of ten: 0.0012, 3.1·10⁻¹⁴. */
export function error(value: number): string {
  if (value === 0 || Math.abs(value) >= 1e-3) return rounded(value, 2);
  const [digits, exponent] = value.toExponential(1).split("e") as [string, string];
  const raised = [...exponent].map((digit) => (digit === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(digit)]));
  return `${digits}·10${raised.join("")}`;
}

/** Appends a unit to a number. */
export const inUnit =
  (unit: string, format: Format = rounded): Format =>
  (value) =>
    `${format(value)}\u00a0${unit}`;

/** The names of rules and modes, as `keepout live` shows them. */
const ruleNames: Readonly<Record<string, string>> = {
  none: "None",
  "no fixture": "No fixture",
  all_faces: "All faces",
  paper: "Li et al.",
  certified: "Certified",
  linearized: "Linearized",
  "tip only": "Tip only",
};

/** Returns the displayed name of a rule or a mode. */
export const ruleName = (name: string): string => ruleNames[name] ?? name;

/** Pointers to names of rules and modes, and to headlines, which have them in quotation marks. */
const toRules = /^\/runs\/\d+\/name$|\/(mode|activation)$/;
const toHeadlines = /\/headline$/;

/** Returns a headline with the displayed names of rules. */
export const headlineText = (text: string): string =>
  text.replaceAll(/'(\w+)'/g, (quoted, name) => ruleNames[name] ?? quoted);

/** Returns the text of a value of the record; a dash if it is missing or has no meaning. */
function textOf(pointer: string, format: Format = trimmed): string {
  const value = valueAt<unknown>(pointer);
  if (value === null || value === undefined || value === "") return "–";
  if (typeof value === "number") return signed(format(value));
  if (toHeadlines.test(pointer)) return headlineText(String(value));
  return toRules.test(pointer) ? ruleName(String(value)) : String(value);
}

/** Shows the value of the record at a pointer in an element. */
export function show<Shown extends Element>(
  element: Shown,
  pointer: string,
  format?: Format,
): Shown {
  element.setAttribute("data-from", pointer);
  element.textContent = textOf(pointer, format);
  return element;
}

/** Returns an element with the value of the record at a pointer, for use within a text. */
export const shown = (pointer: string, format?: Format): HTMLSpanElement =>
  show(make("span"), pointer, format);

/** Returns an element with the last key of a pointer. */
export function shownName(pointer: string): HTMLSpanElement {
  return make("span", { "data-from": pointer, "data-name": "" }, lastKey(pointer));
}

/** Returns a count of the record, and its noun: "1 cycle", "23 cycles". */
export const counted = (pointer: string, noun: string): (Node | string)[] => [
  shown(pointer, grouped),
  ` ${noun}${valueAt(pointer) === 1 ? "" : "s"}`,
];

/** Returns a list in words: "A, B and C". */
export const listed = (parts: readonly (readonly (Node | string)[])[]): (Node | string)[] =>
  parts.flatMap((part, i) => [i === 0 ? "" : i + 1 === parts.length ? " and " : ", ", ...part]);

/** Shows everything at a pointer in full: names and values, and lists of them. */
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

/** Returns names and values of an object of the record, for a list of definitions. */
export const shownMembers = (pointer: string): HTMLElement[] =>
  entries(pointer).flatMap((entry) => [
    make("dt", {}, shownName(entry)),
    make("dd", {}, ...shownWhole(entry)),
  ]);

/** Returns the paragraphs of an array of texts, or of one text, in the record. */
export const paragraphs = (pointer: string, name: string): HTMLElement[] =>
  (Array.isArray(valueAt(pointer)) ? entries(pointer) : [pointer])
    .filter((from) => valueAt(from))
    .map((from) => show(make("p", { class: name }), from));
