// SPDX-License-Identifier: BSD-3-Clause
/** Whole instruments in keepout: apps/web/engine/instrument_exports.cpp says what each export does. */
import type { Anatomy, Keepout, Module, Vec3 } from "./keepout.ts";

/** What the module with instruments has beside the others. */
export interface RobotModule extends Module {
  _keepout_make_instrument(anatomy: number, robot: number, base: number, margin: number): number;
  _keepout_discard_instrument(manipulator: number): void;
  _keepout_instrument_facts(manipulator: number): number;
  _keepout_place_instrument(manipulator: number, positions: number): number;
  _keepout_lead_instrument(manipulator: number, hand: number, maxStep: number): number;
  _keepout_move_instrument(manipulator: number, twist: number): number;
  _keepout_body_clearance(manipulator: number, body: number): number;
}

/** Where a frame is, and how it is turned. */
export interface Frame {
  readonly place: Vec3; // [mm]
  readonly turn: readonly [x: number, y: number, z: number, w: number]; // a unit quaternion
}

/** Where the instrument begins at a mesh: `keepout live` has placed its port. */
export interface InstrumentStart {
  /** Link 0: where it is, and the rows of its rotation (12). */
  readonly base: readonly number[];
  /** Of the joints. [rad or mm] */
  readonly positions: readonly number[];
}

/** What stays the same of an instrument. */
export interface InstrumentFacts {
  readonly joints: number;
  /** What is held back of the margin. [mm] */
  readonly band: number;
  /** Of a cycle. [s] */
  readonly period: number;
  readonly bodies: readonly { readonly name: string; readonly radius: number }[];
}

/** What came of a control cycle. */
export interface InstrumentCycle {
  /** Of the joints, after the cycle. [rad or mm] */
  readonly positions: readonly number[];
  /** That led there. */
  readonly increment: readonly number[];
  /** What was asked of the flange: how it shall move [mm] and turn [rad] (6). */
  readonly twist: readonly number[];
  readonly flange: Frame;
  /** Both ends of each body's axis, after the cycle: (bodies, 6). [mm] */
  readonly cores: readonly number[];
  /** From the body nearest to the surface, as the cycle began; NaN where none is near. [mm] */
  readonly distance: number;
  readonly status: number;
  /** That hold the motion back. */
  readonly rows: number;
  /** Trial motions that were judged. */
  readonly rounds: number;
  /** The number of that body; -1: none is near. */
  readonly nearest: number;
}

/** An instrument that keeps off an anatomy. */
export class Manipulator {
  readonly facts: InstrumentFacts;
  private readonly address: number;
  private readonly input: number;

  constructor(
    private readonly keepout: Keepout<RobotModule>,
    anatomy: Anatomy,
    robot: string,
    start: InstrumentStart,
    margin: number,
  ) {
    const { module } = keepout;
    this.input = keepout.allocate(12 * 8);
    module.HEAPF64.set(start.base, this.input / 8);
    this.address = keepout.given(
      keepout.withText(robot, (name) =>
        module._keepout_make_instrument(anatomy.address, name, this.input, margin),
      ),
    );
    this.facts = JSON.parse(keepout.text(module._keepout_instrument_facts(this.address)));
  }

  /** Puts the joints there, and forgets the past. */
  place(positions: readonly number[]): InstrumentCycle {
    return this.cycle((at) => this.module._keepout_place_instrument(this.address, at), positions);
  }

  /** One control cycle towards where a hand wants the flange, led `maxStep` at most. [mm] */
  lead({ place, turn }: Frame, maxStep: number): InstrumentCycle {
    return this.cycle(
      (at) => this.module._keepout_lead_instrument(this.address, at, maxStep),
      [...place, ...turn],
    );
  }

  /** One control cycle in which just this is asked of the flange (6). */
  move(twist: readonly number[]): InstrumentCycle {
    return this.cycle((at) => this.module._keepout_move_instrument(this.address, at), twist);
  }

  /** From the surface of a body to the mesh, for people: to a twentieth of a millimetre or so. [mm] */
  clearance(body: number): number {
    return this.module._keepout_body_clearance(this.address, body);
  }

  discard(): void {
    this.module._keepout_discard_instrument(this.address);
    this.module._free(this.input);
  }

  private get module(): RobotModule {
    return this.keepout.module;
  }

  private cycle(make: (input: number) => number, input: readonly number[]): InstrumentCycle {
    this.module.HEAPF64.set(input, this.input / 8);
    const address = make(this.input);
    const { HEAPF64, HEAPU32 } = this.module;
    const at = address / 8;
    const numbers = (from: number, count: number) => [
      ...HEAPF64.subarray(at + from, at + from + count),
    ];
    const counts = address / 4 + 252;
    const { joints, bodies } = this.facts;
    return {
      positions: numbers(0, joints),
      increment: numbers(8, joints),
      twist: numbers(16, 6),
      flange: {
        place: numbers(22, 3) as unknown as Vec3,
        turn: numbers(25, 4) as unknown as Frame["turn"],
      },
      distance: HEAPF64[at + 29] as number,
      cores: numbers(30, 6 * bodies.length),
      status: HEAPU32[counts] as number,
      rows: HEAPU32[counts + 1] as number,
      rounds: HEAPU32[counts + 2] as number,
      nearest: (HEAPU32[counts + 3] as number) | 0,
    };
  }
}
