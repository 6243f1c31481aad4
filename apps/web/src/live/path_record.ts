// SPDX-License-Identifier: BSD-3-Clause
import { type Cycle, type Frame, type Tool, unturned } from "../engine/keepout.ts";

/**
 * The format of the cycles of a path, with a line of numbers for each, and how to repeat a cycle.
 */
export interface PathFormat {
  /** Numbers in a line. */
  readonly width: number;
  /** The most lines. */
  readonly most: number;
  readonly line: (before: Cycle, now: Cycle) => readonly number[];
  /** Returns the position of the tool before the cycle of a line. */
  readonly start: (line: readonly number[]) => readonly number[];
  readonly repeat: (tool: Tool, line: readonly number[]) => Cycle;
  /** Returns the hand after a repeated cycle. */
  readonly hand: (now: Cycle) => Frame;
}

/** Cycles of ten minutes. */
export const tenMinutes = 600_000;

/** As `keepout replay --closed-loop`: the hand, and the tip before the cycle; ten minutes. */
const ofTip: PathFormat = {
  width: 6,
  most: tenMinutes,
  line: (before, now) => [...now.asked, ...before.positions],
  start: (line) => line.slice(3),
  repeat: (tool, line) => tool.follow(placed(line)),
  hand: ({ asked }) => placed(asked),
};
const placed = ([x, y, z]: readonly number[]): Frame => ({
  place: [x as number, y as number, z as number],
  turn: unturned,
});

/**
 * The joints before the cycle, their increment, and the commanded motion of the flange; over three
 * minutes.
 */
const ofInstrument = (joints: number): PathFormat => ({
  width: 2 * joints + 6,
  most: 200_000,
  line: (before, now) => [...before.positions, ...now.motion, ...now.asked],
  start: (line) => line.slice(0, joints),
  repeat: (tool, line) => tool.step(line.slice(-6)),
  hand: ({ flange }) => flange,
});

export const pathFormat = ({ subject, facts }: Tool): PathFormat =>
  subject === "tip" ? ofTip : ofInstrument(facts.positions);

/**
 * Records the cycles. Omits a cycle that repeats the command of the one before from the same
 * position, because its result is the same. This requires that the cycle before was ok: after a
 * lack of work budget, the result may change.
 */
export class PathRecord {
  private readonly values: number[] = [];

  constructor(private readonly format: PathFormat) {}

  clear(): void {
    this.values.length = 0;
  }

  /** `wasOk`: true if the cycle before this one was ok. */
  add(line: readonly number[], wasOk: boolean): void {
    const { width, most } = this.format;
    if (this.values.length >= width * most || (wasOk && this.repeatsLast(line))) return;
    this.values.push(...line);
  }

  /** Returns a copy of all lines (n, width). */
  lines(): Float64Array {
    return Float64Array.from(this.values);
  }

  private repeatsLast(line: readonly number[]): boolean {
    const last = this.values.length - this.format.width;
    return last >= 0 && line.every((value, i) => Object.is(value, this.values[last + i]));
  }
}
