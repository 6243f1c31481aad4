// SPDX-License-Identifier: BSD-3-Clause
import { grouped, make } from "../page/elements.ts";
import { valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { type Format, show } from "./shown.ts";

/** A column of a table: what of each row it shows. */
export interface Column {
  readonly heading: string;
  /** Where below a row the value is, as a JSON pointer; "" for the row itself. Rows sort by it. */
  readonly from: string;
  readonly format?: Format;
  /** How a cell looks; `harm` is a number that ought to be nothing. */
  readonly look?: "name" | "words" | "harm";
  /** What is in the cell, where that is more than the value. */
  readonly content?: (row: string) => readonly (Node | string)[];
}

/** A column of numbers: counts, unless there is another format. */
export const column = (heading: string, from: string, format: Format = grouped): Column => ({
  ...{ heading, from, format },
});
/** A column of numbers that ought to be nothing. */
export const harm = (heading: string, from: string, format?: Format): Column => ({
  ...column(heading, from, format),
  look: "harm",
});
/** A column of names. */
export const named = (heading: string, from: string): Column => ({ heading, from, look: "name" });

/**
 * A table of rows that are in the record, at these pointers, sorted by whichever heading is pressed;
 * below it those of `totals`, which stay there.
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

/** A table that scrolls sideways where the page is narrow; by keyboard too. */
export function scrolled(content: HTMLTableElement, name = "scroll"): HTMLElement {
  return make("div", { class: name, tabindex: "0" }, content);
}

/** A section with a table of rows of the record, under the page's words on them. */
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

/** A field that leaves only the rows of a table that have all words that are written there. */
export function rowFilter(content: HTMLTableElement): HTMLElement {
  const field = make("input", { type: "search", placeholder: "wide_bvh paper" });
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
  const isText = look === "name" || look === "words";
  return make(
    "th",
    { scope: "col", ...(isText ? { class: "name" } : {}) },
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
