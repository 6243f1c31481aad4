// SPDX-License-Identifier: BSD-3-Clause
import { type Findings, type GuardSettings, spring } from "../engine/keepout.ts";
import { element, grouped } from "./page.ts";
import type { State } from "./protocol.ts";

/** How each status is to be taken: the colour of its chip. */
const moods: Readonly<Record<string, "free" | "limited">> = {
  free: "free",
  limited: "limited",
  recovering: "limited",
  fallback: "limited",
};

/** The card that tells what keepout does. */
export class Readings {
  private readonly status = element("status", HTMLElement);
  private readonly figure = element("clearance", HTMLElement);
  private readonly spoken = element("spoken", HTMLElement);
  private spokenAt = 0;
  private frames = { at: performance.now(), count: 0 };

  constructor(private readonly statuses: readonly { name: string; reason: string }[]) {}

  /** `frames`: drawn since the beginning. */
  show(state: State, settings: GuardSettings, frames: number): void {
    const { name, reason } = this.statuses[state.status] ?? { name: "unknown", reason: "" };
    const isGuarded = settings.rule !== "none";
    this.status.className = moods[name] ?? "stopped";
    set(this.status.querySelector("b"), isGuarded ? name.replaceAll("_", " ") : "no fixture");
    set(this.status.querySelector("span"), isGuarded ? reason : "nothing holds the tool back");

    // What a screen reader says is heard out before it changes.
    if (state.time - this.spokenAt > 2000) {
      this.spokenAt = state.time;
      set(this.spoken, isGuarded ? `${name}: ${reason}` : "no fixture");
    }

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
    set("step-time", state.rate > 0 ? `${state.stepTime.toFixed(1)} µs` : "–");
    set("rate", state.rate > 0 ? grouped(state.rate) : "–");
    set("limited", `${grouped(state.limited)} of ${grouped(state.cycles)}`);
    set("lost", grouped(state.lost));
    this.countFrames(frames);
  }

  private countFrames(frames: number): void {
    const now = performance.now();
    if (now - this.frames.at < 1000) return;
    const rate = (1000 * (frames - this.frames.count)) / (now - this.frames.at);
    set("frames", rate.toFixed(0));
    this.frames = { at: now, count: frames };
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

function millimetres(length: number): string {
  return `${length.toFixed(2)} mm`;
}

/** Changes a text where it has changed: a screen reader shall not hear what has not. */
function set(where: string | Element | null, text: string): void {
  const place = typeof where === "string" ? document.getElementById(where) : where;
  if (place && place.textContent !== text) place.textContent = text;
}
