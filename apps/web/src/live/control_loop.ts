// SPDX-License-Identifier: BSD-3-Clause
import type { Cycle, Frame, Tool, ToolSettings, Vec3 } from "../engine/keepout.ts";
import { type PathFormat, PathRecord, pathFormat } from "./path_record.ts";

/** The time in which the hand covers 63 % of a jump of the pointer. [cycles] */
const handSmoothing = 8;
/** Statuses up to this one, degraded, have a motion: see keepout/status.h. */
const lastOk = 4;
/** At a smaller distance the hand has arrived. [mm] */
const arrival = 1e-6;

/**
 * The control loop of a robot whose operator moves the pointer. Each cycle is one millisecond. The
 * hand follows the pointer smoothly, because pointers are sampled at most about a hundred times a
 * second. The tool follows the hand as far as keepout allows.
 */
export class ControlLoop {
  readonly record: PathRecord;
  cycles = 0;
  limited = 0;
  /** Result of the last cycle, or of placing the tool. */
  last: Cycle;
  hand: Frame;
  tool: Tool;
  /** True if another loop runs the same cycles: then the path has a line for each cycle. */
  isPaired = false;
  /** If set, returns where a motion of a tip crosses the surface; such motions are counted. */
  wall: ((from: Vec3, to: Vec3) => Vec3 | null) | null = null;
  crossings = 0;
  /** The number of times that the tool was placed. */
  placed = 0;
  crossedAt: Vec3 | null = null;
  private readonly format: PathFormat;
  private pointer: Frame | null = null;
  private replay: { lines: Float64Array; next: number; differs: number; isHeld: boolean } | null =
    null;

  constructor(
    private readonly make: (settings: ToolSettings) => Tool,
    private settings_: ToolSettings,
    positions: readonly number[],
  ) {
    this.tool = make(settings_);
    this.format = pathFormat(this.tool);
    this.record = new PathRecord(this.format);
    this.last = this.tool.place(positions);
    this.hand = this.last.flange;
  }

  get settings(): ToolSettings {
    return this.settings_;
  }

  /**
   * Continues with other settings, and starts a new path. The hand stays where it is. If the engine
   * rejects the settings, throws and changes nothing.
   */
  use(settings: ToolSettings): void {
    const tool = this.make(settings);
    this.discard();
    this.tool = tool;
    this.settings_ = settings;
    const { replay, hand, pointer } = this;
    this.place(this.last.positions);
    // A replay restarts with the new settings.
    if (replay !== null) {
      this.startReplay(replay.lines, replay.isHeld);
      return;
    }
    this.hand = hand;
    this.pointer = pointer;
  }

  /** Places tool and hand; starts a new path. */
  place(positions: readonly number[]): void {
    this.last = this.tool.place(positions);
    this.hand = this.last.flange;
    this.pointer = this.replay = null;
    this.record.clear();
    ++this.placed;
    this.crossings = 0;
    this.crossedAt = null;
  }

  /** Sets where the pointer holds the hand; null: it has released the hand. Ends a replay. */
  hold(pointer: Frame | null): void {
    if (pointer !== null && ![...pointer.place, ...pointer.turn].every(Number.isFinite)) return;
    if (this.replay !== null && pointer === null) return;
    this.replay = null;
    this.pointer = pointer;
  }

  /**
   * Repeats a recorded path, from the tool's first position. (n, width), n > 0. `isHeld`: true if the hand then
   * stays where it is.
   */
  startReplay(lines: Float64Array, isHeld: boolean): void {
    this.place(this.format.start([...lines.subarray(0, this.format.width)]));
    this.replay = { lines, next: 0, differs: -1, isHeld };
  }

  /**
   * Runs one cycle. At the end of a replay, returns its number of cycles and the first one that
   * differs.
   */
  run(): { cycles: number; differs: number } | null {
    const { last: before, replay, format, tool } = this;
    const { width } = format;
    const recorded =
      replay &&
      ([...replay.lines.subarray(width * replay.next, width * (replay.next + 1))] as const);
    if (recorded !== null) {
      this.last = format.repeat(tool, recorded);
      this.hand = format.hand(this.last);
    } else {
      // A released hand returns to the tool.
      this.hand = between(this.hand, this.pointer ?? before.flange, 1 / handSmoothing);
      this.last = tool.follow(this.hand);
    }
    const line = this.count(before);
    if (replay === null) return null;
    const isSame = line.every((value, i) => Object.is(value, recorded?.[i]));
    if (!isSame && replay.differs < 0) replay.differs = replay.next;
    if (width * ++replay.next < replay.lines.length) return null;
    this.replay = null;
    if (replay.isHeld) this.pointer = this.hand;
    return { cycles: replay.next, differs: replay.differs };
  }

  /** Runs one cycle with the hand of another loop. */
  follow(hand: Frame): void {
    const before = this.last;
    this.hand = hand;
    this.last = this.tool.follow(hand);
    this.count(before);
  }

  /** Records and counts the last cycle. Returns its line. */
  private count(before: Cycle): readonly number[] {
    const line = this.format.line(before, this.last);
    this.record.add(line, !this.isPaired && before.status <= lastOk);
    ++this.cycles;
    if (this.last.held > 0) ++this.limited;
    const place = this.wall?.(before.flange.place, this.last.flange.place);
    if (place) {
      ++this.crossings;
      this.crossedAt = place;
    }
    return line;
  }

  discard(): void {
    this.tool.made.delete();
  }
}

/**
 * Returns the frame at a fraction of the way between two frames; the second frame if both almost
 * coincide.
 */
function between(from: Frame, to: Frame, share: number): Frame {
  const sign =
    from.turn.reduce((sum, value, i) => sum + value * (to.turn[i] as number), 0) < 0 ? -1 : 1;
  const off = Math.hypot(
    ...from.place.map((value, i) => value - (to.place[i] as number)),
    ...from.turn.map((value, i) => value - sign * (to.turn[i] as number)),
  );
  if (off < arrival) return to;
  const place = from.place.map((value, i) => value + share * ((to.place[i] as number) - value));
  const turn = from.turn.map((value, i) => value + share * (sign * (to.turn[i] as number) - value));
  const length = Math.hypot(...turn);
  return {
    place: place as unknown as Frame["place"],
    turn: turn.map((value) => value / length) as unknown as Frame["turn"],
  };
}
