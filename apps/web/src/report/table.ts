// SPDX-License-Identifier: BSD-3-Clause
import { grouped, make } from "../page/elements.ts";
import { valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { type Format, show } from "./shown.ts";

/** A column of a table. */
export interface Column {
  readonly heading: string;
  /** The pointer to the value, below a row; "" for the row itself. Rows sort by it. */
  readonly from: string;
  readonly format?: Format;
  /** The appearance of a cell; `harm` is a number that must be zero. */
  readonly look?: "name" | "words" | "harm";
  /** The content of the cell, if it is more than the value. */
  readonly content?: (row: string) => readonly (Node | string)[];
}

/** Returns a column of numbers: counts, unless another format is given. */
export const column = (heading: string, from: string, format: Format = grouped): Column => ({
  ...{ heading, from, format },
});
/** Returns a column of numbers that must be zero. */
export const harm = (heading: string, from: string, format?: Format): Column => ({
  ...column(heading, from, format),
  look: "harm",
});
/** Returns a column of names. */
export const named = (heading: string, from: string): Column => ({ heading, from, look: "name" });

/**
 * Returns a table of the rows at these pointers, sorted by the heading that the reader presses. The
 * rows of `totals` stay below them.
 */
export function table(
  rows: readonly string[],
  columns: readonly Column[],
  totals: readonly string[] = [],
): HTMLTableElement {
  const body = make("tbody");
  const heads = columns.map((column) => heading(column));
  const lines = rows.map((row) => line(row, columns));
  body.append(...lines.map(({ element }) => element));

  heads.forEach((head, place) => {
    head.querySelector("button")?.addEventListener("click", () => {
      const falls = head.getAttribute("aria-sort") === "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", falls ? "descending" : "ascending");
      const pointer = columns[place]?.from ?? "";
      const sorted = [...lines].sort((a, b) => {
        const [one, other] = [valueAt(a.row + pointer), valueAt(b.row + pointer)];
        if (isNothing(one) || isNothing(other))
          return Number(isNothing(one)) - Number(isNothing(other));
        return (falls ? -1 : 1) * order(one, other);
      });
      body.append(...sorted.map(({ element }) => element));
    });
  });
  const foot = make("tfoot", {}, ...totals.map((row) => line(row, columns).element));
  return make("table", {}, make("thead", {}, make("tr", {}, ...heads)), body, foot);
}

/** Returns a table that scrolls sideways on a narrow page, also by keyboard. */
export function scrolled(content: HTMLTableElement, name = "scroll"): HTMLElement {
  return make("div", { class: name, tabindex: "0" }, content);
}

/** Returns a section with a table of rows of the record, below an explanation. */
export const tableSection = (
  title: Node | string,
  words: readonly (Node | string)[],
  rows: readonly string[],
  columns: readonly Column[],
  ...more: readonly (Node | string)[]
): HTMLElement =>
  section(
    title,
    ...(words.length > 0 ? [lead(...words)] : []),
    scrolled(table(rows, columns)),
    ...more,
  );

/** Returns a field that hides the rows of a table that lack one of the typed words. */
export function rowFilter(content: HTMLTableElement): HTMLElement {
  const field = make("input", { type: "search", placeholder: "wide_bvh certified" });
  field.addEventListener("input", () => {
    const words = field.value.toLowerCase().split(/\s+/);
    for (const row of content.tBodies[0]?.rows ?? []) {
      const text = [...row.cells].map((cell) => cell.textContent.toLowerCase()).join(" ");
      row.hidden = !words.every((word) => text.includes(word));
    }
  });
  return make("label", { class: "filter" }, "Only rows with ", field);
}

function heading({ heading: text, look }: Column): HTMLElement {
  const kinds = [
    ...(look === "name" || look === "words" ? ["name"] : []),
    ...(text.length > 14 ? ["long"] : []),
  ];
  return make(
    "th",
    { scope: "col", ...(kinds.length > 0 ? { class: kinds.join(" ") } : {}) },
    make("button", { type: "button" }, text),
  );
}

function line(row: string, columns: readonly Column[]) {
  const element = make("tr");
  columns.forEach(({ from, format, look, content }, place) => {
    const cell = place === 0 ? make("th", { scope: "row" }) : make("td");
    if (content) cell.append(...content(row));
    else show(cell, row + from, format);
    const isHarm = look === "harm" && Number(valueAt(row + from)) > 0;
    const name = look === "harm" ? (isHarm ? "bad" : "") : (look ?? "");
    if (name !== "") cell.className = name;
    element.append(cell);
  });
  return { row, element };
}

const isNothing = (value: unknown): boolean =>
  value === null || value === undefined || value === "";

function order(one: unknown, other: unknown): number {
  if (typeof one === "number" && typeof other === "number") return one - other;
  return String(one).localeCompare(String(other), "en", { numeric: true });
}
