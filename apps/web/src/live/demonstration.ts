// SPDX-License-Identifier: BSD-3-Clause
import type { Frame, Vec3 } from "../engine/keepout.ts";
import type { State } from "./protocol.ts";

/** Duration of each phase. [s] */
const duration = { approach: 4, press: 1.4, slide: 3, back: 1.3 } as const;
type Phase = keyof typeof duration;

/** Lengths of the motion, and its directions, which are unit vectors. [mm] */
export interface Course {
  readonly towards: Vec3;
  readonly across: Vec3;
  /** The distance of the tool from the surface at the start. */
  readonly distance: number;
  /** The distances that the hand moves beyond the contact, and to each side. */
  readonly depth: number;
  readonly width: number;
}

/**
 * Moves the hand by itself in the first seconds: up to the surface, into it, along it, and back. So the visitor
 * sees what the page does, and then takes over.
 */
export class Demonstration {
  private phase: Phase = "approach";
  private begun: number | null = null;
  /** The advance of the hand at the contact. [mm] */
  private contact = 0;

  /**
   * `hold`: called with the hand, or null at the end. `say`: called with each phase, and with null at the end, unless
   * the visitor takes over. If the hand meets no surface, the demonstration ends after the approach.
   */
  constructor(
    private readonly start: Frame,
    private readonly course: Course,
    private readonly hold: (hand: Frame | null) => void,
    private readonly say: (phase: Phase | null) => void,
  ) {
    say("approach");
  }

  /** Moves the hand on. Returns false at the end. */
  advance({ time, held, byMesh }: State): boolean {
    this.begun ??= time;
    const share = (time - this.begun) / (1000 * duration[this.phase]);
    const { distance, depth, width } = this.course;
    const [advance, aside] = {
      approach: () => [2 * share * distance, 0],
      press: () => [this.contact + Math.min(1.5 * share, 1) * depth, 0],
      slide: () => [this.contact + depth, width * Math.sin(2 * Math.PI * share)],
      back: () => [(1 - share) * (this.contact + depth), 0],
    }[this.phase]() as [number, number];
    this.move(advance, aside);
    if (this.phase === "approach" && held > 0 && byMesh) {
      this.contact = advance;
      this.enter("press", time);
    } else if (share >= 1) {
      if (this.phase === "press") this.enter("slide", time);
      else if (this.phase === "slide") this.enter("back", time);
      else return this.end(true);
    }
    return true;
  }

  /** Releases the hand. */
  end(isComplete: boolean): false {
    this.hold(null);
    if (isComplete) this.say(null);
    return false;
  }

  private enter(phase: Phase, time: number): void {
    this.phase = phase;
    this.begun = time;
    this.say(phase);
  }

  private move(advance: number, aside: number): void {
    const { towards, across } = this.course;
    const place = this.start.place.map(
      (value, i) => value + advance * (towards[i] as number) + aside * (across[i] as number),
    ) as unknown as Vec3;
    this.hold({ ...this.start, place });
  }
}
