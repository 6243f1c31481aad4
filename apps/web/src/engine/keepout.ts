// SPDX-License-Identifier: BSD-3-Clause
/**
 * keepout itself, compiled to WebAssembly. apps/web/engine/exports.cpp documents the functions, and
 * tool.h the numbers of a tool and of a cycle. Lengths are in mm, forces in N, coordinates in the
 * frame of the mesh. A function that fails throws an Error with keepout's message.
 */

export type Vec3 = readonly [x: number, y: number, z: number];

/** The engine that emscripten makes: build/wasm/keepout.mjs. */
export interface Keepout {
  shapes(): string[];
  statuses(subject: Subject): StatusWords[];
  counterexamples(): Counterexample[];
  anatomyOfSurface(vertices: Float64Array, corners: Uint32Array): Anatomy;
  anatomyOfFile(name: string, bytes: Uint8Array): Anatomy;
  anatomyOfShape(name: string): Anatomy;
  makeTool(
    anatomy: Anatomy,
    settings: ToolSettings & typeof spring & { port: Port | null },
  ): EngineTool;
}

/** Emscripten's loader, which creates the engine: build/wasm/keepout.mjs. */
export type ModuleFactory = (options: {
  wasmBinary: Uint8Array;
  locateFile: (name: string) => string;
}) => Promise<Keepout>;

/** Loads the engine from its binary; reads no file. */
export const loadKeepout = (make: ModuleFactory, wasmBinary: Uint8Array): Promise<Keepout> =>
  make({ wasmBinary, locateFile: (name) => name });

/** A mesh and its index, which all tools on it share. Tools must be deleted first. */
export interface Anatomy {
  surface(): { vertices: Float64Array; corners: Uint32Array };
  findings(): Findings;
  clearance(...place: Vec3): number;
  /** Returns true if the surface is between two places (6 numbers). */
  isBetween(...places: readonly number[]): boolean;
  delete(): void;
}

/** Findings of `keepout inspect` about a mesh. */
export interface Findings {
  readonly watertight: boolean;
  readonly size: Vec3;
  readonly warnings: readonly string[];
  readonly findings: readonly { readonly text: string; readonly advice: string }[];
}

/** A small mesh, and a motion on which the rule of Li et al. (2020) fails. */
export interface Counterexample {
  readonly name: string;
  readonly vertices: readonly Vec3[];
  readonly triangles: readonly Vec3[];
  readonly tip: Vec3;
  readonly desired: Vec3;
  readonly radius: number;
}

/** The texts of a status. */
export interface StatusWords {
  readonly name: string;
  readonly reason: string;
}

/** The ball of a tip, or a whole instrument. */
export type Subject = "tip" | "instrument";

/**
 * The activation rule of a tip; with "none" the tip follows the hand anywhere. An instrument has
 * "none", "tip_only", which guards a ball at the end of its jaw, and "certified".
 */
export type Rule = "none" | "all_faces" | "paper" | "certified" | "tip_only";

/** Settings of a tool. The radius of a tool applies to a tip only. */
export interface ToolSettings {
  readonly rule: Rule;
  /** Radius of the motion sphere: the longest motion of the tip in a cycle. [mm] */
  readonly radius: number;
  /** Radius of the ball around the tip. [mm] */
  readonly toolRadius: number;
  /** Clearance beyond the radius. [mm] */
  readonly margin: number;
  /** The longest desired motion of a cycle. [mm] */
  readonly maxStep: number;
  /** Texts of guidance constraints, as `--guide` takes them. A tip has them only under a rule. */
  readonly guides: readonly string[];
  /** The angle between the jaws, of an instrument only. [deg] */
  readonly opening?: number;
}

/** The robot of an instrument, and its link 0: position, and rows of the rotation (12). */
export interface Port {
  readonly robot: string;
  readonly base: readonly number[];
}

/** The spring between hand and tip. */
export const spring = { stiffness: 1 /* N/mm */, largestForce: 4 /* N */ } as const;

/** A position and an orientation. */
export interface Frame {
  readonly place: Vec3; // [mm]
  readonly turn: readonly [x: number, y: number, z: number, w: number]; // a unit quaternion
}

/** The orientation of the hand that moves a tip. */
export const unturned: Frame["turn"] = [0, 0, 0, 1];

/** A guidance constraint. */
export interface Guide {
  readonly name: string;
  /** True if it bounds a direction: then its region contains unit vectors, and is not drawn. */
  readonly isAngular: boolean;
  readonly kind: "half_space" | "slab" | "tube" | "ball";
  readonly origin: Vec3; // [mm]
  readonly direction: Vec3; // into a half-space, across a slab, along a tube
  readonly radius: number; // [mm]
}

/** The constant properties of a tool. */
export interface ToolFacts {
  readonly positions: number;
  readonly asked: number;
  readonly band: number; // [mm]
  readonly period: number; // [s]
  readonly bodies: readonly { readonly name: string; readonly radius: number }[];
  /** The point that follows the hand: its link, and its position in the link's frame. [mm] */
  readonly link: number;
  readonly end: Vec3;
  readonly guides: readonly Guide[];
}

/** A half-space {u : normal . u >= offset} of allowed increments, and its triangle. */
export interface Plane {
  readonly normal: Vec3;
  readonly offset: number;
  readonly triangle: number;
  readonly isActive: boolean;
}

/** Result of a control cycle. */
export interface Cycle {
  readonly positions: readonly number[];
  readonly motion: readonly number[];
  readonly asked: readonly number[];
  readonly flange: Frame;
  readonly force: Vec3; // [N]
  readonly distance: number;
  readonly status: number;
  readonly held: number;
  readonly rounds: number;
  readonly nearest: number;
  readonly triangles: number;
  readonly planeCount: number;
  /** True if the clearance from the mesh limits the motion. */
  readonly byMesh: boolean;
  /** Bit g is set if guide g limits the motion. */
  readonly guides: number;
  /**
   * The largest distance of a guided point from its region; below 0 inside, NaN without guides.
   * [mm]
   */
  readonly excess: number;
  readonly cores: readonly number[]; // (bodies, 6)
}

/** A tool of the engine, whose cycles are numbers: struct Cycle of apps/web/engine/tool.h. */
interface EngineTool {
  facts(): ToolFacts;
  place(positions: readonly number[]): Float64Array;
  follow(...hand: readonly number[]): Float64Array;
  step(...asked: readonly number[]): Float64Array;
  clearance(body: number): number;
  /** The point of a body's core that is nearest to the surface, and that point of the surface. */
  contact(body: number): number[];
  planes(): Plane[];
  delete(): void;
}

/**
 * A tool that keepout constrains beside an anatomy: an instrument at a port, or the ball of a tip.
 */
export class Tool {
  readonly facts: ToolFacts;
  readonly subject: Subject;
  /** The engine's tool; the owner must delete it. */
  readonly made: EngineTool;

  constructor(keepout: Keepout, anatomy: Anatomy, settings: ToolSettings, port: Port | null) {
    this.made = keepout.makeTool(anatomy, { ...settings, ...spring, port });
    this.facts = this.made.facts();
    this.subject = port === null ? "tip" : "instrument";
  }

  /** Sets the position of the tip or the joints, and resets all state. */
  place(positions: readonly number[]): Cycle {
    return this.cycle(this.made.place(positions));
  }

  /** Runs one control cycle towards the hand; for a tip like `keepout replay --closed-loop`. */
  follow({ place, turn }: Frame): Cycle {
    return this.cycle(this.made.follow(...place, ...turn));
  }

  /**
   * Runs one step (6 numbers): of a tip from a position by an increment, or of an instrument by a
   * twist of the flange.
   */
  step(asked: readonly number[]): Cycle {
    return this.cycle(this.made.step(...asked));
  }

  private cycle(view: Float64Array): Cycle {
    const numbers = [...view] as const;
    const some = (from: number, count: number) => numbers.slice(from, from + count);
    const one = (at: number) => numbers[at] as number;
    return {
      positions: some(0, this.facts.positions),
      motion: some(8, this.facts.positions),
      asked: some(16, this.facts.asked),
      flange: {
        place: some(22, 3) as unknown as Vec3,
        turn: some(25, 4) as unknown as Frame["turn"],
      },
      force: some(29, 3) as unknown as Vec3,
      distance: one(32),
      status: one(33),
      held: one(34),
      rounds: one(35),
      nearest: one(36),
      triangles: one(37),
      planeCount: one(38),
      byMesh: one(39) > 0,
      guides: one(40),
      excess: one(41),
      cores: numbers.slice(42),
    };
  }
}
