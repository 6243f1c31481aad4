// SPDX-License-Identifier: BSD-3-Clause
import { type Cycle, type Frame, type Tool, unturned } from "../engine/keepout.ts";

/** How a path has the cycles of a tool, a line of numbers each, and how a cycle is done again. */
export interface PathFormat {
  /** Numbers in a line. */
  readonly width: number;
  /** Lines at most. */
  readonly most: number;
  readonly line: (before: Cycle, now: Cycle) => readonly number[];
  /** Where the tool was before the cycle of a line. */
  readonly start: (line: readonly number[]) => readonly number[];
  readonly repeat: (tool: Tool, line: readonly number[]) => Cycle;
  /** Where the hand is after a cycle that was repeated. */
  readonly hand: (now: Cycle) => Frame;
}

/** Cycles of ten minutes. */
export const tenMinutes = 600_000;

/** As `keepout replay --closed-loop`: where the hand is, and where the tip was before; ten minutes. */
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

/** Where the joints were, their increment, and what was asked of the flange; over three minutes. */
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
 * The past, cycle by cycle. A cycle that asks for what the one before asked, from the same place, has
 * the same answer and is left out, if the one before was ok: one that ran out of work may have more
 * of it the next time.
 */
export class PathRecord {
  private readonly values: number[] = [];

  constructor(private readonly format: PathFormat) {}

  clear(): void {
    this.values.length = 0;
  }

  /** `wasOk`: whether the cycle before this one was. */
  add(line: readonly number[], wasOk: boolean): void {
    const { width, most } = this.format;
    if (this.values.length >= width * most || (wasOk && this.repeatsLast(line))) return;
    this.values.push(...line);
  }

  /** (n, width), copied. */
  lines(): Float64Array {
    return Float64Array.from(this.values);
  }

  private repeatsLast(line: readonly number[]): boolean {
    const last = this.values.length - this.format.width;
    return last >= 0 && line.every((value, i) => Object.is(value, this.values[last + i]));
  }
}
