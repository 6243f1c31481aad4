// SPDX-License-Identifier: BSD-3-Clause
/**
 * What was, cycle by cycle: a line of so many numbers each. Of a ball there are six, as `keepout
 * replay --closed-loop` has them, the goal of the cycle and the tip before it. A cycle that asks
 * for what the one before asked, from the same place, has the same answer and is left out, if the
 * one before was ok: one that ran out of work may have more of it the next time.
 */
export class PathRecord {
  private lines_: Float64Array;
  private count_ = 0;

  /** `width`: numbers in a line; beyond so many lines, nothing is taken down. */
  constructor(
    private readonly width: number,
    private readonly capacity: number,
  ) {
    this.lines_ = new Float64Array(width * 1024);
  }

  get count(): number {
    return this.count_;
  }

  get isFull(): boolean {
    return this.count_ >= this.capacity;
  }

  clear(): void {
    this.count_ = 0;
  }

  /** `wasOk`: whether the cycle before this one was. */
  add(line: readonly number[], wasOk: boolean): void {
    if (this.isFull || (wasOk && this.repeatsLast(line))) return;
    if (this.width * (this.count_ + 1) > this.lines_.length) {
      const longer = new Float64Array(2 * this.lines_.length);
      longer.set(this.lines_);
      this.lines_ = longer;
    }
    this.lines_.set(line, this.width * this.count_);
    ++this.count_;
  }

  /** (n, width), copied. */
  lines(): Float64Array {
    return this.lines_.slice(0, this.width * this.count_);
  }

  private repeatsLast(line: readonly number[]): boolean {
    if (this.count_ === 0) return false;
    const at = this.width * (this.count_ - 1);
    return line.every((value, i) => Object.is(value, this.lines_[at + i]));
  }
}
