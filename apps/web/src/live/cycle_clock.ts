// SPDX-License-Identifier: BSD-3-Clause

/** The largest number of late cycles that still run. */
const mostBehind = 100;
/** The interval between messages to the page. [ms] */
const tellEvery = 15;

/**
 * Runs a control loop at 1 kHz. Browsers wake a worker every few milliseconds at best; at each
 * wake-up, all due cycles run.
 */
export class CycleClock {
  /** Cycles that were due but did not run because the processor was busy. */
  lost = 0;
  /** Cycles per second, over the last second. */
  rate = 0;
  /** Mean time of a cycle, over the last second. [µs] */
  stepTime = 0;
  private begun = 0; // the worker's clock at cycle 0 [ms]
  private done = 0; // cycles since then, run or lost
  private told = 0; // time of the last message to the page [ms]
  private paused = false;
  private second = { begin: 0, cycles: 0, busy: 0 };

  /** Restarts: no cycle is due. */
  restart(): void {
    this.begun = performance.now();
    this.done = 0;
    this.second = { begin: this.begun, cycles: 0, busy: 0 };
  }

  pause(paused: boolean): void {
    this.paused = paused;
    if (!paused) this.restart();
  }

  /** Runs the due cycles. Returns the time if a message to the page is due, else null. [ms] */
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
