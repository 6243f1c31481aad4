// SPDX-License-Identifier: BSD-3-Clause
import { element, grouped, set } from "./page.ts";

/** A status in words. */
export interface StatusWords {
  readonly name: string;
  readonly reason: string;
}

/** What a control loop of any tool tells of its cycles. */
export interface LoopState {
  /** Of the worker's clock, at the last cycle. [ms] */
  readonly time: number;
  readonly status: number;
  /** All cycles since the anatomy was loaded, and those in which something held the tool back. */
  readonly cycles: number;
  readonly limited: number;
  /** Cycles that were due and not run, as the processor was busy. */
  readonly lost: number;
  /** Of a cycle, over the last second. [us] */
  readonly stepTime: number;
  /** Cycles a second, over the last second. */
  readonly rate: number;
}

/** How each status is to be taken: the colour of its chip. */
const moods: Readonly<Record<string, "free" | "limited">> = {
  free: "free",
  limited: "limited",
  recovering: "limited",
  fallback: "limited",
  yielding: "limited",
};

/** How the last cycle ended, in a chip and in words, and how the loop keeps its time. */
export class StatusLine {
  private readonly status = element("status", HTMLElement);
  private spokenAt = 0;
  private frames = { at: performance.now(), count: 0 };

  constructor(private readonly statuses: readonly StatusWords[]) {}

  /** `frames`: drawn since the beginning. */
  show(state: LoopState, isGuarded: boolean, frames: number): void {
    const { name, reason } = this.statuses[state.status] ?? { name: "unknown", reason: "" };
    this.status.className = moods[name] ?? "stopped";
    set(this.status.querySelector("b"), isGuarded ? name.replaceAll("_", " ") : "no fixture");
    set(this.status.querySelector("span"), isGuarded ? reason : "nothing holds the tool back");

    // What a screen reader says is heard out before it changes.
    if (state.time - this.spokenAt > 2000) {
      this.spokenAt = state.time;
      set("spoken", isGuarded ? `${name}: ${reason}` : "no fixture");
    }

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
