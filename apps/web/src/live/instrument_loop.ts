// SPDX-License-Identifier: BSD-3-Clause
import type { Frame, InstrumentCycle, Manipulator } from "../engine/manipulator.ts";
import { handSmoothing, lastOk } from "./control_loop.ts";
import { PathRecord } from "./path_record.ts";

/** Cycles that are kept: more than three minutes at 1 kHz. */
export const mostKept = 200_000;

/**
 * The control loop of a robot whose surgeon is the pointer: each cycle is one millisecond. The hand
 * goes to where the pointer wants the flange, smoothly; the joints follow as far as is proven.
 */
export class InstrumentLoop {
  /** Lines of three times as many numbers as joints: where they were, by how much they went, and, six, what was asked. */
  readonly record: PathRecord;
  cycles = 0;
  limited = 0;
  last: InstrumentCycle;
  private hand_: Frame;
  private pointer: Frame | null = null;
  private replay: { lines: Float64Array; next: number; differs: number } | null = null;

  constructor(
    readonly manipulator: Manipulator,
    private readonly maxStep: number,
    positions: readonly number[],
  ) {
    this.record = new PathRecord(this.width, mostKept);
    this.last = manipulator.place(positions);
    this.hand_ = this.last.flange;
  }

  /** Where the hand wants the flange. */
  get hand(): Frame {
    return this.hand_;
  }

  /** Numbers of a line. */
  get width(): number {
    return 2 * this.manipulator.facts.joints + 6;
  }

  /** Puts the joints there; a new path begins. */
  place(positions: readonly number[]): void {
    this.last = this.manipulator.place(positions);
    this.hand_ = this.last.flange;
    this.pointer = this.replay = null;
    this.record.clear();
  }

  /** Where the pointer holds the hand; null: it has let go. Ends a replay. */
  hold(pointer: Frame | null): void {
    if (pointer !== null && ![...pointer.place, ...pointer.turn].every(Number.isFinite)) return;
    if (this.replay !== null && pointer === null) return;
    this.replay = null;
    this.pointer = pointer;
  }

  /** Asks again for what was asked on record, from where the joints began. */
  startReplay(lines: Float64Array): void {
    this.place([...lines.subarray(0, this.manipulator.facts.joints)]);
    this.replay = { lines, next: 0, differs: -1 };
  }

  /** One cycle. Gives, at the end of a replay, how many cycles it had, and the first that differs. */
  run(): { cycles: number; differs: number } | null {
    const before = this.last;
    this.hand_ = this.nextHand();
    this.last =
      this.replay === null
        ? this.manipulator.lead(this.hand_, this.maxStep)
        : this.manipulator.move(this.replayed().subarray(-6) as unknown as number[]);
    const line = [...before.positions, ...this.last.increment, ...this.last.twist];
    this.record.add(line, before.status <= lastOk);
    ++this.cycles;
    if (this.last.rows > 0) ++this.limited;
    return this.advanceReplay(line);
  }

  discard(): void {
    this.manipulator.discard();
  }

  /** The line on record for this cycle. */
  private replayed(): Float64Array {
    const { lines, next } = this.replay as { lines: Float64Array; next: number };
    return lines.subarray(this.width * next, this.width * (next + 1));
  }

  private nextHand(): Frame {
    if (this.replay !== null) return this.last.flange;
    // Let go, the hand is drawn to the flange.
    return between(this.hand_, this.pointer ?? this.last.flange, 1 / handSmoothing);
  }

  private advanceReplay(line: readonly number[]): { cycles: number; differs: number } | null {
    const { replay } = this;
    if (replay === null) return null;
    const recorded = this.replayed();
    const isSame = line.every((value, i) => Object.is(value, recorded[i]));
    if (!isSame && replay.differs < 0) replay.differs = replay.next;
    if (this.width * ++replay.next < replay.lines.length) return null;
    this.replay = null;
    return { cycles: replay.next, differs: replay.differs };
  }
}

/** A share of the way from one frame to another; of what is nearer than matters: the other. */
function between(from: Frame, to: Frame, share: number): Frame {
  const sign =
    from.turn.reduce((sum, value, i) => sum + value * (to.turn[i] as number), 0) < 0 ? -1 : 1;
  const off = Math.hypot(
    ...from.place.map((value, i) => value - (to.place[i] as number)),
    ...from.turn.map((value, i) => value - sign * (to.turn[i] as number)),
  );
  if (off < 1e-6) return to;
  const place = from.place.map((value, i) => value + share * ((to.place[i] as number) - value));
  const turn = from.turn.map((value, i) => value + share * (sign * (to.turn[i] as number) - value));
  const length = Math.hypot(...turn);
  return {
    place: place as unknown as Frame["place"],
    turn: turn.map((value) => value / length) as unknown as Frame["turn"],
  };
}
