// SPDX-License-Identifier: BSD-3-Clause
import { MathUtils, Quaternion } from "three";
import {
  type Rule,
  type StatusWords,
  spring,
  type ToolFacts,
  type ToolSettings,
} from "../engine/keepout.ts";
import { grouped, make } from "../page/elements.ts";
import { type AnatomyWords, anatomyWords } from "./anatomy_words.ts";
import { element, isTip, millimetres, set } from "./page.ts";
import type { State } from "./protocol.ts";
import { reachedBody } from "./robot_surroundings.ts";
import { robotStatusShown, whereabouts } from "./robot_words.ts";
import { statusShown } from "./status_words.ts";

/** The card with keepout's readings. The page of each tool has some of the figures. */
export class Readings {
  private readonly status = element("status", HTMLElement);
  private readonly figure = element("clearance", HTMLElement);
  private readonly out = element("out", HTMLButtonElement);
  private readonly bodies = new Map<string, HTMLElement>();
  private spokenAt = 0;
  private words: AnatomyWords = anatomyWords("");
  private frames = { at: performance.now(), count: 0 };

  constructor(private readonly statuses: readonly StatusWords[]) {}

  /** Sets the name of the anatomy, for sentences. */
  name(mesh: string): void {
    this.words = anatomyWords(mesh);
  }

  /** `frames`: the number of frames since the beginning. */
  show(state: State, settings: ToolSettings, facts: ToolFacts, frames: number): void {
    const isGuarded = settings.rule !== "none";
    this.showStatus(state, settings.rule, facts);
    set("whereabouts", whereabouts(state, settings.rule, this.words));
    this.showClearances(state, facts, isGuarded);
    // This rule holds a tool that is inside: only the user can take it out.
    const isStuck = Math.min(...state.clearances) < 0 && state.motion.every((part) => part === 0);
    this.out.hidden = !isStuck || !isGuarded || settings.rule === "tip_only";
    this.showGuides(state, facts);
    const newtons = Math.hypot(...state.force);
    const bar = document.querySelector<HTMLElement>("#force i");
    if (bar) bar.style.width = `${(100 * newtons) / spring.largestForce}%`;
    set("newtons", `${newtons.toFixed(2)} N`);
    const { hand, flange } = state;
    const way = Math.hypot(...hand.place.map((value, i) => value - (flange.place[i] as number)));
    const turn = new Quaternion(...hand.turn).angleTo(new Quaternion(...flange.turn));
    const degrees = MathUtils.radToDeg(turn);
    set("hand-off", `${millimetres(way)}, ${degrees.toFixed(0)}°`);
    set("margin-kept", isGuarded ? millimetres(settings.margin) : "–");
    const planes = isTip ? `${state.planes.length} of ${state.planeCount}` : `${state.held}`;
    set("planes", isGuarded ? planes : "–");
    set("triangles", isGuarded ? grouped(state.triangles) : "–");
    set("rounds", `${state.rounds}`);
    set("step-time", state.rate > 0 ? `${state.stepTime.toFixed(1)} µs` : "–");
    set("rate", state.rate > 0 ? grouped(state.rate) : "–");
    set("limited", `${grouped(state.limited)} of ${grouped(state.cycles)}`);
    set("lost", grouped(state.lost));
    this.countFrames(frames);
  }

  /** Shows the outcome of the last cycle, in a chip and in words. */
  private showStatus(state: State, rule: Rule, facts: ToolFacts): void {
    const name = this.statuses[state.status]?.name ?? "unknown";
    const { chip, sentence, mood } = isTip
      ? statusShown(name, state, rule !== "none")
      : robotStatusShown(name, state, facts, rule, this.words);
    this.status.className = mood;
    set(this.status.querySelector("b"), chip);
    set(this.status.querySelector("span"), sentence);
    // A screen reader finishes a sentence before the text changes.
    if (performance.now() - this.spokenAt <= 2000) return;
    this.spokenAt = performance.now();
    set("spoken", `${chip}: ${sentence}`);
  }

  /** Shows the guides that limit the tool, or how far outside of a guide it is. */
  private showGuides({ guides: limiting, excess }: State, { guides }: ToolFacts): void {
    const row = element("guide-state", HTMLElement);
    const holding = guides.filter((_, g) => Math.floor(limiting / 2 ** g) % 2 === 1);
    row.className = holding.length > 0 ? "guided" : "";
    const where = excess > 0.01 ? `${millimetres(excess)} outside` : "inside";
    const names = [...new Set(holding.map(({ name }) => name.replaceAll("_", " ")))];
    const words = holding.length > 0 ? `held by ${names.join(", ")}` : where;
    set(row, guides.length > 0 ? words : "–");
  }

  private showClearances(state: State, { bodies }: ToolFacts, isGuarded: boolean): void {
    const { clearances } = state;
    const least = Math.min(...clearances);
    this.figure.parentElement?.classList.toggle("inside", least < 0);
    set(this.figure, Number.isNaN(least) ? "–" : millimetres(least));
    if (isTip) {
      set("clearance-words", least < 0 ? "inside the surface" : "from tool to surface");
      return;
    }
    set("clearance-words", `from the ${bodies[clearances.indexOf(least)]?.name} to the surface`);
    const held = state.held > 0 ? reachedBody(state, clearances) : -1;
    const byOther = state.guides > 0 ? "by a guide" : "–";
    const otherwise = isGuarded && least < 0 ? "by the mesh" : byOther;
    set("held", held < 0 ? otherwise : `by the ${bodies[held]?.name}`);
    // Both jaws have one row.
    for (const name of new Set(bodies.map((body) => body.name))) {
      const of = clearances.filter((_, i) => bodies[i]?.name === name);
      const row = this.rowOf(name);
      set(row, millimetres(Math.min(...of)));
      row.className = name === bodies[held]?.name ? "held" : "";
    }
  }

  /** Returns the row with the clearance of a body. */
  private rowOf(body: string): HTMLElement {
    let row = this.bodies.get(body);
    if (row === undefined) {
      row = make("dd");
      element("bodies", HTMLElement).append(make("dt", {}, `From the ${body}`), row);
      this.bodies.set(body, row);
    }
    return row;
  }

  private countFrames(frames: number): void {
    const now = performance.now();
    if (now - this.frames.at < 1000) return;
    const rate = (1000 * (frames - this.frames.count)) / (now - this.frames.at);
    set("frames", rate.toFixed(0));
    this.frames = { at: now, count: frames };
  }
}
