// SPDX-License-Identifier: BSD-3-Clause
import type { Anatomy, Cycle, Guard, GuardSettings, Keepout, Vec3 } from "../engine/keepout.ts";
import { PathRecord } from "./path_record.ts";
import { mostCycles } from "./protocol.ts";

/** How long the hand takes to come by 63 % to where the pointer has jumped. [cycles] */
export const handSmoothing = 8;
/** Statuses up to this one, yielding, come with a motion: see keepout/status.h. */
export const lastOk = 4;
/** Nearer than this the hand is there. [mm] */
const arrival = 1e-6;

/**
 * The control loop of a robot whose surgeon is the pointer: each cycle is one millisecond. The hand
 * goes to where the pointer is, smoothly, as pointers are seen a hundred times a second and less;
 * the tool goes towards the hand as far as the guard allows.
 */
export class ControlLoop {
  readonly record = new PathRecord(6, mostCycles);
  cycles = 0;
  limited = 0;
  /** What the last cycle came to; of none yet: null. */
  last: Cycle | null = null;
  private guard: Guard;
  private tip_: Vec3;
  private hand_: Vec3;
  private pointer: Vec3 | null = null;
  private replay: { lines: Float64Array; next: number; differs: number } | null = null;

  constructor(
    private readonly keepout: Keepout,
    readonly anatomy: Anatomy,
    private settings_: GuardSettings,
    place: Vec3,
  ) {
    this.guard = keepout.guard(anatomy, settings_);
    this.tip_ = this.hand_ = place;
    this.place(place);
  }

  get tip(): Vec3 {
    return this.tip_;
  }

  get hand(): Vec3 {
    return this.hand_;
  }

  get settings(): GuardSettings {
    return this.settings_;
  }

  activePlanes() {
    return this.last === null ? [] : this.guard.activePlanes();
  }

  /** Goes on from here as another guard would; what it refuses is thrown, and nothing changes. */
  use(settings: GuardSettings): void {
    const guard = this.keepout.guard(this.anatomy, settings);
    this.guard.discard();
    this.guard = guard;
    this.settings_ = settings;
    const { replay } = this;
    this.place(this.tip_);
    // Of what is replayed, the same again under what is now chosen.
    if (replay !== null) this.startReplay(replay.lines);
  }

  /** Puts tool and hand there; a new path begins. */
  place(tip: Vec3): void {
    this.tip_ = this.hand_ = tip;
    this.pointer = this.replay = this.last = null;
    this.guard.place(tip);
    this.record.clear();
  }

  /** Where the pointer holds the hand; null: it has let go. Ends a replay. */
  hold(pointer: Vec3 | null): void {
    if (pointer !== null && !pointer.every(Number.isFinite)) return;
    if (this.replay !== null) {
      if (pointer === null) return;
      this.replay = null;
    }
    this.pointer = pointer;
  }

  /** Follows a recorded hand from where its tool began. (n, 6), n > 0 */
  startReplay(lines: Float64Array): void {
    this.place([lines[3] as number, lines[4] as number, lines[5] as number]);
    this.replay = { lines, next: 0, differs: -1 };
  }

  /** One cycle. Gives, at the end of a replay, how many cycles it had, and the first that differs. */
  run(): { cycles: number; differs: number } | null {
    const before = this.tip_;
    this.hand_ = this.nextHand();
    const wasOk = this.last !== null && this.last.status <= lastOk;
    this.last = this.guard.follow(this.hand_);
    this.tip_ = this.last.tip;
    this.record.add([...this.hand_, ...before], wasOk);
    ++this.cycles;
    if (this.last.activeCount > 0) ++this.limited;
    return this.advanceReplay(before);
  }

  discard(): void {
    this.guard.discard();
  }

  private nextHand(): Vec3 {
    if (this.replay !== null) {
      const { lines, next } = this.replay;
      return [
        lines[6 * next] as number,
        lines[6 * next + 1] as number,
        lines[6 * next + 2] as number,
      ];
    }
    // Let go, the hand is drawn to the tool.
    const towards = this.pointer ?? this.tip_;
    const way = towards.map((value, i) => value - (this.hand_[i] as number)) as unknown as Vec3;
    if (Math.hypot(...way) < arrival) return towards;
    const share = 1 / handSmoothing;
    return this.hand_.map((value, i) => value + share * (way[i] as number)) as unknown as Vec3;
  }

  private advanceReplay(before: Vec3): { cycles: number; differs: number } | null {
    const { replay } = this;
    if (replay === null) return null;
    const at = 6 * replay.next + 3;
    const isSame = before.every((value, i) => Object.is(value, replay.lines[at + i]));
    if (!isSame && replay.differs < 0) replay.differs = replay.next;
    if (6 * ++replay.next < replay.lines.length) return null;
    this.replay = null;
    return { cycles: replay.next, differs: replay.differs };
  }
}
