// SPDX-License-Identifier: BSD-3-Clause

/** Cycles that are due and no more caught up with. */
const mostBehind = 100;
/** Between two words to the page. [ms] */
const tellEvery = 15;

/**
 * Keeps a control loop at 1 kHz. Browsers wake a worker every few milliseconds at best; each time,
 * all cycles that are due are run.
 */
export class CycleClock {
  /** Cycles that were due and not run, as the processor was busy. */
  lost = 0;
  /** Cycles a second, over the last second. */
  rate = 0;
  /** Of a cycle, over the last second. [us] */
  stepTime = 0;
  private begun = 0; // the worker's clock at cycle 0 [ms]
  private done = 0; // cycles since, run or lost
  private told = 0; // when the page was last told [ms]
  private paused = false;
  private second = { begin: 0, cycles: 0, busy: 0 };

  /** Starts anew: nothing is due. */
  restart(): void {
    this.begun = performance.now();
    this.done = 0;
    this.second = { begin: this.begun, cycles: 0, busy: 0 };
  }

  pause(paused: boolean): void {
    this.paused = paused;
    if (!paused) this.restart();
  }

  /** Runs what is due. Gives the time, when the page is to be told; else null. [ms] */
  run(cycle: () => void): number | null {
    if (this.paused) return null;
    const { second } = this;
    const now = performance.now();
    let due = Math.floor(now - this.begun) - this.done;
    if (due > mostBehind) {
      this.lost += due - mostBehind;
      this.done += due - mostBehind;
      due = mostBehind;
    }
    for (; due > 0; --due, ++this.done, ++second.cycles) cycle();
    const after = performance.now();
    second.busy += after - now;
    if (after - second.begin >= 1000) {
      this.rate = (1000 * second.cycles) / (after - second.begin);
      this.stepTime = (1000 * second.busy) / Math.max(second.cycles, 1);
      Object.assign(second, { begin: after, cycles: 0, busy: 0 });
    }
    if (after - this.told < tellEvery) return null;
    this.told = after;
    return after;
  }
}
