// SPDX-License-Identifier: BSD-3-Clause
/** Tools of keepout: apps/web/engine/tool.h says what each call does. Lengths are in mm. */
import type { Keepout, Vec3 } from "./keepout.ts";

/** The ball of a tip, or a whole instrument. */
export type Subject = "tip" | "instrument";

/** The rule that keeps a tip out; with "none" it goes wherever the hand leads. */
export type Rule = "none" | "all_faces" | "paper" | "certified";

/** Settings of a tool; rule and both radii are of a tip only. */
export interface ToolSettings {
  readonly rule: Rule;
  /** Of the motion sphere: the longest motion of the tip in a cycle. [mm] */
  readonly radius: number;
  /** Of the ball around the tip. [mm] */
  readonly toolRadius: number;
  /** Distance to keep beyond that. [mm] */
  readonly margin: number;
  /** The longest motion that a cycle asks for. [mm] */
  readonly maxStep: number;
}

/** The robot of an instrument, and its link 0: place, and rows of the rotation (12). */
export interface Port {
  readonly robot: string;
  readonly base: readonly number[];
}

/** The spring between hand and tip. */
export const spring = { stiffness: 1 /* N/mm */, largestForce: 4 /* N */ } as const;

/** A place and an orientation. */
export interface Frame {
  readonly place: Vec3; // [mm]
  readonly turn: readonly [x: number, y: number, z: number, w: number]; // a unit quaternion
}

/** The orientation of the hand that leads a tip. */
export const unturned: Frame["turn"] = [0, 0, 0, 1];

/** Facts of a tool that stay the same. */
export interface ToolFacts {
  /** Numbers of a position: three of a tip, one for each joint of an instrument. */
  readonly positions: number;
  /** Allowance for curvature, taken from the margin. [mm] */
  readonly band: number;
  /** Of a cycle. [s] */
  readonly period: number;
  readonly bodies: readonly { readonly name: string; readonly radius: number }[];
}

/** A half-space {u : normal . u >= offset} of allowed increments, and the triangle it is of. */
export interface Plane {
  readonly normal: Vec3;
  readonly offset: number;
  readonly triangle: number;
}

/** Result of a control cycle. */
export interface Cycle {
  /** Of the tip or the joints, after the cycle. [mm or rad] */
  readonly positions: readonly number[];
  /** Increment in the cycle. */
  readonly motion: readonly number[];
  /** Of a tip: the hand's place (3). Of an instrument: motion and rotation of the flange (6). */
  readonly asked: readonly number[];
  /** The frame that the hand leads, after the cycle. */
  readonly flange: Frame;
  /** On the hand of a tip. [N] */
  readonly force: Vec3;
  /** From the tip or the nearest body before the cycle to the surface; NaN: not known. [mm] */
  readonly distance: number;
  /** Both ends of each body's axis, after the cycle: (bodies, 6). [mm] */
  readonly cores: readonly number[];
  readonly status: number;
  /** Planes or rows that limit the motion. */
  readonly held: number;
  /** Trial motions of an instrument that were judged. */
  readonly rounds: number;
  /** The number of the nearest body; -1: not known. */
  readonly nearest: number;
  /** Triangles that the step of a tip rests on. */
  readonly triangles: number;
  readonly planeCount: number;
}

/** A tool that keepout constrains beside an anatomy. */
export class Tool {
  readonly facts: ToolFacts;
  private last = 0;

  constructor(
    private readonly keepout: Keepout,
    private readonly address: number,
    readonly subject: Subject,
  ) {
    this.facts = keepout.json(keepout.module._keepout_tool_facts(address));
  }

  /** Puts the tip or the joints there, and forgets the past. */
  place(positions: readonly number[]): Cycle {
    return this.call("_keepout_place", positions);
  }

  /** One control cycle towards the hand; of a tip as `keepout replay --closed-loop`. */
  follow({ place, turn }: Frame): Cycle {
    return this.call("_keepout_follow", [...place, ...turn]);
  }

  /** One step (6): of a tip from a place by an increment, of an instrument by a twist of the flange. */
  step(asked: readonly number[]): Cycle {
    return this.call("_keepout_step", asked);
  }

  /** From the surface of a body to the mesh. [mm] */
  clearance(body: number): number {
    return this.keepout.module._keepout_body_clearance(this.address, body);
  }

  /** The planes that limited the last motion of a tip, from where it is now. */
  activePlanes(): Plane[] {
    if (this.last === 0) return [];
    const { HEAPU32, HEAPF64 } = this.keepout.module;
    const motion = HEAPF64.subarray(this.last / 8 + 8, this.last / 8 + 11);
    const counts = this.last / 4 + 258;
    const [planeCount, planes, active] = HEAPU32.subarray(counts + 5, counts + 8) as unknown as [
      number,
      number,
      number,
    ];
    return [...HEAPU32.subarray(active / 4, active / 4 + (HEAPU32[counts + 1] as number))]
      .filter((number) => number < planeCount)
      .map((number) => {
        const at = planes / 8 + 5 * number;
        const normal = [...HEAPF64.subarray(at, at + 3)] as unknown as Vec3;
        const made = normal.reduce((sum, n, i) => sum + n * (motion[i] as number), 0);
        return {
          normal,
          offset: (HEAPF64[at + 3] as number) - made,
          triangle: HEAPU32[2 * (at + 4)] as number,
        };
      });
  }

  discard(): void {
    this.keepout.module._keepout_discard_tool(this.address);
  }

  /** Calls an export with numbers, and reads the cycle that it returns. */
  private call(
    name: "_keepout_place" | "_keepout_follow" | "_keepout_step",
    numbers: readonly number[],
  ): Cycle {
    const { module } = this.keepout;
    this.last = this.keepout.withNumbers(numbers, (at) => module[name](this.address, at));
    const { HEAPF64, HEAPU32 } = module;
    const doubles = (from: number, count: number) => {
      const at = this.last / 8 + from;
      return [...HEAPF64.subarray(at, at + count)];
    };
    const [status, held, rounds, nearest, triangles, planeCount] = HEAPU32.subarray(
      this.last / 4 + 258,
      this.last / 4 + 264,
    ) as unknown as readonly [number, number, number, number, number, number];
    const { positions, bodies } = this.facts;
    return {
      positions: doubles(0, positions),
      motion: doubles(8, positions),
      asked: doubles(16, this.subject === "tip" ? 3 : 6),
      flange: {
        place: doubles(22, 3) as unknown as Vec3,
        turn: doubles(25, 4) as unknown as Frame["turn"],
      },
      force: doubles(29, 3) as unknown as Vec3,
      distance: HEAPF64[this.last / 8 + 32] as number,
      cores: doubles(33, 6 * bodies.length),
      ...{ status, held, rounds, nearest: nearest | 0, triangles, planeCount },
    };
  }
}
