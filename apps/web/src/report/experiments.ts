// SPDX-License-Identifier: BSD-3-Clause
/** The sections of the experiments that reproduce Li et al. (2020). */
import { make } from "../page/elements.ts";
import { drawnSvg } from "./drawn_svg.ts";
import { below, entries, valueAt } from "./record.ts";
import { lead, panels, section } from "./report_page.ts";
import { paragraphs, show, shown } from "./shown.ts";
import { type Column, named, scrolled, table } from "./table.ts";

/**
 * Returns the published numbers of all experiments beside ours, then the results of each
 * experiment.
 */
export function experimentSections(): HTMLElement[] {
  const all = entries("/experiments");
  return [...findings(all), ...claims(all), ...all.map(found)];
}

/** Returns the result of each experiment in a sentence, for the place under the headline. */
function findings(all: readonly string[]): HTMLElement[] {
  const lines = all
    .filter((experiment) => valueAt(`${experiment}/headline`))
    .map((experiment) =>
      make(
        "li",
        {},
        make("span", { class: "of" }, shown(`${experiment}/title`)),
        shown(`${experiment}/headline`),
      ),
    );
  return lines.length > 0 ? [make("ul", { class: "differences" }, ...lines)] : [];
}

/** Returns the pointer to the experiment of a claim. */
const experimentOf = (claim: string): string => claim.split("/").slice(0, 3).join("/");

const claimColumns: readonly Column[] = [
  {
    heading: "what",
    from: "/about",
    content: (claim) => [
      shown(`${claim}/about`),
      make("span", { class: "of" }, shown(`${experimentOf(claim)}/title`)),
    ],
  },
  named("evidence", "/sure"),
  named("paper", "/paper"),
  named("its rule here", "/reproduction"),
  named("certified", "/certified"),
  named("best", "/best"),
  { heading: "why it differs", from: "/note", look: "words" },
];

function claims(all: readonly string[]): HTMLElement[] {
  const rows = all.flatMap((experiment) => entries(below(experiment, "claims")));
  if (rows.length === 0) return [];
  return [
    section(
      "Compared with Li et al.",
      lead(
        "What the paper prints; what its rule does here, under the same conditions as the others; what the certified rule does; and which does best.",
      ),
      scrolled(table(rows, claimColumns), "scroll claims"),
    ),
  ];
}

/** Returns the results of an experiment: a sentence, tables and pictures. */
function found(experiment: string): HTMLElement {
  const heading = show(make("h2", { class: "part" }), `${experiment}/title`);
  const tables = entries(`${experiment}/tables`).flatMap((one) => [
    show(make("h3"), `${one}/title`),
    scrolled(textTable(one)),
    ...paragraphs(`${one}/note`, "lead note"),
  ]);
  const figures = entries(`${experiment}/figures`).map((one) => panels(picture(one)));
  return make(
    "section",
    {},
    heading,
    ...paragraphs(`${experiment}/headline`, "account"),
    ...tables,
    ...figures,
  );
}

const isNumber = (text: string): boolean => /^([-−–+]?\d|[<>≤≥]|[-–]?$)/.test(text);

/** Returns a table whose headings and rows are text in the record. */
function textTable(pointer: string): HTMLTableElement {
  const headings = entries(`${pointer}/columns`);
  const rows = entries(`${pointer}/rows`);
  const columns = headings.map((from, place): Column => {
    const areNumbers = rows.every((row) => isNumber(valueAt<string>(below(row, place)) ?? ""));
    return {
      heading: valueAt<string>(from) ?? "",
      from: `/${place}`,
      ...(areNumbers ? {} : { look: "name" }),
    };
  });
  const made = table(rows, columns);
  for (const [place, button] of [...made.querySelectorAll("thead button")].entries()) {
    show(button, headings[place] ?? "");
  }
  return made;
}

/** Returns a picture with title and caption, which scrolls sideways on a narrow page. */
function picture(figure: string): HTMLElement {
  const title = valueAt<string>(`${figure}/title`) ?? "";
  const drawn = drawnSvg(valueAt<string>(`${figure}/svg`) ?? "", title);
  drawn.className = "picture_of_record";
  const name = show(make("span", { class: "name" }), `${figure}/title`);
  return make(
    "figure",
    {},
    make("figcaption", {}, name, make("br"), shown(`${figure}/caption`)),
    make("div", { class: "sideways", tabindex: "0" }, drawn),
  );
}
