// SPDX-License-Identifier: BSD-3-Clause
import { millimetres, set } from "./page.ts";
import type { StatusShown } from "./status_words.ts";

/** The line above a pane: a chip with the state of the tool, and its distance from the surface. */
export class SideHead {
  private readonly chip: HTMLElement;
  private readonly figure: HTMLElement;

  constructor(head: Element) {
    [this.chip, this.figure] = [".chip", ".gap"].map((part) => head.querySelector(part)) as [
      HTMLElement,
      HTMLElement,
    ];
  }

  /** `clearance`: NaN if it is unknown. [mm] `isBehind`: true if the tool went through the surface. */
  show(
    chip: string,
    mood: StatusShown["mood"],
    clearance: number,
    isBehind = false,
    digits = 2,
  ): void {
    this.chip.className = `chip ${mood}`;
    set(this.chip, chip);
    const isKnown = Number.isFinite(clearance);
    const length = millimetres(isBehind ? Math.abs(clearance) : clearance, digits);
    set(this.figure, isKnown ? `${length} ${isBehind ? "behind" : "from"} the surface` : "–");
  }
}
