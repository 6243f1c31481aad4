// SPDX-License-Identifier: BSD-3-Clause
import { make, saveFile } from "../page/elements.ts";
import { entries, type ReportRecord, readRecord, recordText, valueAt } from "./record.ts";
import {
  headlineText,
  paragraphs,
  rounded,
  show,
  shown,
  shownMembers,
  shownWhole,
} from "./shown.ts";

/** The content of a page between its headline and its machine. */
type Sections = (main: HTMLElement, record: ReportRecord) => void | Promise<void>;

/** Builds the page for the record in it. `kinds`: the supported records, by `keepout_record`. */
export async function showReport(kinds: Readonly<Record<string, Sections>>): Promise<void> {
  const main = document.querySelector("main") as HTMLElement;
  try {
    const record = await readRecord();
    const sections = kinds[record.keepout_record];
    if (!sections) throw new Error(`this page does not show '${record.keepout_record}'`);
    document.title = `${headlineText(record.headline)} – keepout ${record.keepout_record}`;
    main.replaceChildren(
      show(make("p", { class: "eyebrow" }), "/subject"),
      show(make("h1"), "/headline"),
      ...paragraphs("/account", "account"),
    );
    if (!record.complete) main.append(extent(record));
    try {
      await sections(main, record);
    } finally {
      main.append(circumstances(record));
    }
  } catch (error) {
    main.append(make("p", { class: "account", role: "alert" }, String(error)));
    throw error;
  }
}

/** Explains why a record does not have all results. */
function extent({ keepout_record }: ReportRecord): HTMLElement {
  // Experiments that were stopped write no record.
  return keepout_record === "experiments"
    ? make("p", { class: "account" }, "This run made a selection of the experiments.")
    : make(
        "p",
        { class: "account bad" },
        "The command was stopped: this page shows the finished part.",
      );
}

/** Returns a section under a heading. */
export function section(title: Node | string, ...content: readonly (Node | string)[]): HTMLElement {
  return make("section", {}, make("h2", {}, title), ...content);
}

/** Returns a paragraph of the page's own text under a heading. */
export const lead = (...content: readonly (Node | string)[]): HTMLElement =>
  make("p", { class: "lead" }, ...content);

/** Returns the sentences that say what differs, for the place under the headline. */
export const differences = (
  ...sentences: readonly (readonly (Node | string)[])[]
): HTMLElement[] => {
  const words = sentences.filter((sentence) => sentence.length > 0);
  if (words.length === 0) return [];
  const content = words.flatMap((sentence, i) => [...(i > 0 ? [" "] : []), ...sentence]);
  return [make("p", { class: "differences" }, ...content)];
};

/** Returns the line of the most important numbers, each with its name. */
export const numbersLine = (
  ...numbers: readonly (readonly [Node | string, Node | string])[]
): HTMLElement =>
  make(
    "dl",
    { class: "numbers" },
    ...numbers.map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value))),
  );

/** Returns a paragraph on how something was measured. */
export const method = (...words: readonly (Node | string)[]): HTMLElement =>
  make("p", { class: "method" }, ...words);

/** Returns cards with plots, side by side if the page is wide enough. */
export const panels = (...figures: readonly HTMLElement[]): HTMLElement => {
  const columns = figures.length === 4 ? 2 : figures.length; // four in a row are too narrow
  return make("div", { class: "panels wide charts", style: `--columns:${columns}` }, ...figures);
};

/** Returns the known facts of a machine, for a list of definitions. */
function machineFacts(pointer: string): HTMLElement[] {
  const gibibytes = (value: number) => `${rounded(value)} GiB`;
  return [
    ["processor", "processor"],
    ["cores", "cores"],
    ["memory", "memory_gib", gibibytes],
    ["SIMD target", "simd"],
    ["system", "system"],
    ["compiler", "compiler"],
    ["flags", "flags"],
    ["build type", "build_type"],
    ["keepout", "keepout"],
    ["libraries", "libraries"],
  ].flatMap(([name, key, format]) => {
    const from = `${pointer}/${key}`;
    const value = valueAt<unknown>(from);
    if (!value) return [];
    const content = format ? [shown(from, format as typeof gibibytes)] : shownWhole(from);
    return [make("dt", {}, name as string), make("dd", {}, ...content)];
  });
}

/** Returns the machine of a campaign with one shard, which has no other machine. */
const onlyShard = (): HTMLElement[] =>
  entries("/shards").length === 1
    ? [make("dt", {}, "machine"), show(make("dd"), "/shards/0/machine")]
    : [];

/** Returns how the record was made, and how to repeat or save it. */
function circumstances(record: ReportRecord): HTMLElement {
  const copy = make("button", { type: "button" }, "Copy");
  copy.addEventListener("click", async () => {
    await navigator.clipboard.writeText(record.command);
    copy.textContent = "Copied";
  });
  const save = make("button", { type: "button" }, "Save the figures");
  save.addEventListener("click", () => {
    const date = record.date.replaceAll(":", "");
    saveFile(`keepout-${record.keepout_record}-${date}.json`, recordText(), "application/json");
  });
  const facts = [
    make("dt", {}, "date"),
    show(make("dd"), "/date"),
    ...machineFacts("/machine"),
    ...onlyShard(),
  ];
  const lists = [facts, shownMembers("/settings")].filter((list) => list.length > 0);
  return section(
    "Where it was done, and how to do it again",
    panels(...lists.map((list) => make("figure", {}, make("dl", {}, ...list)))),
    make("div", { class: "command" }, show(make("code"), "/command"), copy),
    make("p", {}, save),
  );
}
