// SPDX-License-Identifier: BSD-3-Clause
import { type Findings, type GuardSettings, spring } from "../engine/keepout.ts";
import { element, grouped, millimetres, set } from "./page.ts";
import type { State } from "./protocol.ts";
import { StatusLine, type StatusWords } from "./status_line.ts";

/** The card that tells what keepout does. */
export class Readings {
  private readonly line: StatusLine;
  private readonly figure = element("clearance", HTMLElement);

  constructor(statuses: readonly StatusWords[]) {
    this.line = new StatusLine(statuses);
  }

  /** `frames`: drawn since the beginning. */
  show(state: State, settings: GuardSettings, frames: number): void {
    const isGuarded = settings.rule !== "none";
    this.line.show(state, isGuarded, frames);
    const isInside = state.toolClearance < 0;
    this.figure.parentElement?.classList.toggle("inside", isInside);
    set(this.figure, Number.isNaN(state.toolClearance) ? "–" : millimetres(state.toolClearance));
    set(
      element("clearance-words", HTMLElement),
      isInside ? "the tool is in" : "from tool to surface",
    );

    const newtons = Math.hypot(...state.force);
    const bar = element("force", HTMLElement).querySelector("i");
    if (bar) bar.style.width = `${(100 * newtons) / spring.largestForce}%`;
    set("newtons", `${newtons.toFixed(2)} N`);
    set("margin-kept", isGuarded ? millimetres(settings.margin) : "–");
    set("planes", isGuarded ? `${state.planes.length} of ${state.planeCount}` : "–");
    set("triangles", isGuarded ? grouped(state.triangles) : "–");
  }
}

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
