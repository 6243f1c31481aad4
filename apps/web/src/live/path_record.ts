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
  private lines_: Float64Array;
  private count = 0;

  constructor(private readonly format: PathFormat) {
    this.lines_ = new Float64Array(format.width * 1024);
  }

  clear(): void {
    this.count = 0;
  }

  /** `wasOk`: whether the cycle before this one was. */
  add(line: readonly number[], wasOk: boolean): void {
    const { width, most } = this.format;
    if (this.count >= most || (wasOk && this.repeatsLast(line))) return;
    if (width * (this.count + 1) > this.lines_.length) {
      const longer = new Float64Array(2 * this.lines_.length);
      longer.set(this.lines_);
      this.lines_ = longer;
    }
    this.lines_.set(line, width * this.count);
    ++this.count;
  }

  /** (n, width), copied. */
  lines(): Float64Array {
    return this.lines_.slice(0, this.format.width * this.count);
  }

  private repeatsLast(line: readonly number[]): boolean {
    if (this.count === 0) return false;
    const at = this.format.width * (this.count - 1);
    return line.every((value, i) => Object.is(value, this.lines_[at + i]));
  }
}
