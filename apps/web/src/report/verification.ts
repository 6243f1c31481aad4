// SPDX-License-Identifier: BSD-3-Clause
/** The sections of a campaign that looks for a step that breaks the theorem. */
import { make } from "../page/elements.ts";
import { entries, lastKey, valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { error, mean, shownMembers, shownWhole } from "./shown.ts";
import { type Column, column, harm, named, scrolled, table } from "./table.ts";

/** A column for each member that is not nothing in all. */
const membersOf = (key: string, kind: typeof column): Column[] =>
  entries(`/total/${key}`)
    .filter((member) => kind === harm || valueAt<number>(member) !== 0)
    .map((member) => kind(lastKey(member).replaceAll("_", " "), `/${key}/${lastKey(member)}`));

/** What was done on each mesh and what came out, in which shards, and each breach in full. */
export function verificationSections(): HTMLElement[] {
  const work: readonly Column[] = [
    { heading: "mesh", from: "/mesh" },
    column("triangles", "/triangles"),
    column("trajectories", "/trajectories"),
    column("steps", "/steps"),
    column("tips", "/tips"),
    column("led out", "/led_out"),
    ...membersOf("breaches", harm),
    column("least beyond margin [mm]", "/least_beyond_margin", error),
    column("the same in τ", "/least_beyond_margin_in_tau", error),
    column("time [s]", "/seconds", mean),
  ];
  const statuses: readonly Column[] = [
    { heading: "mesh", from: "/mesh" },
    column("steps", "/steps"),
    ...membersOf("statuses", column),
  ];
  const shards: readonly Column[] = [
    { heading: "shard", from: "/index" },
    column("time [s]", "/seconds", mean),
    named("complete", "/complete"),
    { heading: "machine", from: "/machine", look: "words" },
  ];
  const meshes = entries("/meshes");
  return [
    section(
      "What was tried, and what broke",
      lead(
        "Each trajectory places a tip, or several, and leads it over the mesh; each step is held to the theorem by an independent judge. Breaches ought to be none.",
      ),
      scrolled(table(meshes, work, ["/total"])),
      ...(entries("/missing").length > 0
        ? [lead("Meshes that could not be had: ", ...shownWhole("/missing"), ".")]
        : []),
    ),
    section("How the steps ended", scrolled(table(meshes, statuses, ["/total"]))),
    section("The shards", scrolled(table(entries("/shards"), shards))),
    ...incidents("/breaches", "The first breaches, with all that it takes to do them again"),
    ...incidents("/anomalies", "What else was odd"),
  ];
}

function incidents(from: string, title: string): HTMLElement[] {
  const all = entries(from).map((incident) =>
    make("figure", {}, make("dl", {}, ...shownMembers(incident))),
  );
  return all.length > 0
    ? [section(title, make("div", { class: "panels wide", style: "--columns:1" }, ...all))]
    : [];
}
