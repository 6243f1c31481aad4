// SPDX-License-Identifier: BSD-3-Clause
import type { Vec3 } from "../engine/keepout.ts";

/**
 * Where hand and tool were, cycle by cycle: six numbers each, as a line of `keepout replay
 * --closed-loop` has them, the goal of the cycle and the tip before it. A cycle that asks for what
 * the one before asked, from the same tip, has the same answer and is left out, if the one before
 * was ok: one that ran out of work may have more of it the next time.
 */
export class PathRecord {
  /** Ten minutes at 1 kHz; beyond, nothing is taken down. */
  static readonly capacity = 600_000;
  private lines_ = new Float64Array(6 * 1024);
  private count_ = 0;

  get count(): number {
    return this.count_;
  }

  get isFull(): boolean {
    return this.count_ >= PathRecord.capacity;
  }

  clear(): void {
    this.count_ = 0;
  }

  /** `wasOk`: whether the cycle before this one was. */
  add(goal: Vec3, tip: Vec3, wasOk: boolean): void {
    if (this.isFull || (wasOk && this.repeatsLast(goal, tip))) return;
    if (6 * (this.count_ + 1) > this.lines_.length) {
      const longer = new Float64Array(2 * this.lines_.length);
      longer.set(this.lines_);
      this.lines_ = longer;
    }
    this.lines_.set(goal, 6 * this.count_);
    this.lines_.set(tip, 6 * this.count_ + 3);
    ++this.count_;
  }

  /** (n, 6), copied. */
  lines(): Float64Array {
    return this.lines_.slice(0, 6 * this.count_);
  }

  private repeatsLast(goal: Vec3, tip: Vec3): boolean {
    if (this.count_ === 0) return false;
    const at = 6 * (this.count_ - 1);
    return [...goal, ...tip].every((value, i) => Object.is(value, this.lines_[at + i]));
  }
}
