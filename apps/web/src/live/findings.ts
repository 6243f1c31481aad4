// SPDX-License-Identifier: BSD-3-Clause
import type { Findings } from "../engine/keepout.ts";
import { element, grouped, set } from "./page.ts";

/** What `keepout inspect` would say of the mesh, and what `keepout live` had to say. */
export function showFindings(
  { watertight, size, warnings, findings }: Findings,
  triangles: number,
  told: readonly string[],
): void {
  const details = element("findings", HTMLDetailsElement);
  const list = document.createElement("ul");
  for (const { text, advice } of findings) list.append(item(`${text}. ${sentence(advice)}`));
  for (const warning of warnings) list.append(item(`In the file: ${warning}.`));
  for (const warning of told) list.append(item(`${warning}.`));
  const facts = document.createElement("p");
  facts.textContent =
    `${grouped(triangles)} triangles; ${size.map((length) => Number(length.toPrecision(4))).join(" × ")} mm; ` +
    (watertight ? "watertight" : "not watertight");
  const count = findings.length + warnings.length + told.length;
  set(
    details.querySelector("summary"),
    count === 0 ? "The mesh: nothing wrong" : `The mesh: ${count} finding${count > 1 ? "s" : ""}`,
  );
  details.querySelector("div")?.replaceChildren(facts, list);
}

function item(text: string): HTMLLIElement {
  const line = document.createElement("li");
  line.textContent = text;
  return line;
}

function sentence(advice: string): string {
  return `What to do: ${advice}.`;
}
