// SPDX-License-Identifier: BSD-3-Clause
/**
 * keepout itself, compiled to WebAssembly: apps/web/engine/exports.cpp says what each function does,
 * tool.h there what the numbers of a tool and of a cycle are. Lengths are in mm, forces in N,
 * coordinates in the frame of the mesh. A function that fails throws an Error with keepout's message.
 */

export type Vec3 = readonly [x: number, y: number, z: number];

/** The engine, as emscripten makes it of build/wasm/keepout.mjs. */
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

/** What emscripten's loader makes an engine of: build/wasm/keepout.mjs. */
export type ModuleFactory = (options: {
  wasmBinary: Uint8Array;
  locateFile: (name: string) => string;
}) => Promise<Keepout>;

/** Loads the engine from its binary: no file is looked for. */
export const loadKeepout = (make: ModuleFactory, wasmBinary: Uint8Array): Promise<Keepout> =>
  make({ wasmBinary, locateFile: (name) => name });

/** A mesh and its index, which all tools on it share: they are deleted before it. */
export interface Anatomy {
  surface(): { vertices: Float64Array; corners: Uint32Array };
  findings(): Findings;
  clearance(...place: Vec3): number;
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

/** A status in words. */
export interface StatusWords {
  readonly name: string;
  readonly reason: string;
}

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
  /** Texts of guidance constraints, as `--guide` takes them. A tip has them only under a rule. */
  readonly guides: readonly string[];
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

/** A guidance constraint: something stays in a region. */
export interface Guide {
  readonly name: string;
  /** It bounds a direction, and its region is of unit vectors: it is not drawn. */
  readonly isAngular: boolean;
  readonly kind: "half_space" | "slab" | "tube" | "ball";
  readonly origin: Vec3; // [mm]
  readonly direction: Vec3; // into a half-space, across a slab, along a tube
  readonly radius: number; // [mm]
}

/** Facts of a tool that stay the same. */
export interface ToolFacts {
  readonly positions: number;
  readonly asked: number;
  readonly band: number; // [mm]
  readonly period: number; // [s]
  readonly bodies: readonly { readonly name: string; readonly radius: number }[];
  /** The end of the last body: its link, and its place in the frame of that. [mm] */
  readonly link: number;
  readonly end: Vec3;
  readonly guides: readonly Guide[];
}

/** A half-space {u : normal . u >= offset} of allowed increments, and the triangle it is of. */
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
  /** The clearance from the mesh limits the motion. */
  readonly byMesh: boolean;
  /** Bit g is set if guide g limits the motion. */
  readonly guides: number;
  /** How far something is out of its guide; below 0 inside, NaN without guides. [mm] */
  readonly excess: number;
  readonly cores: readonly number[]; // (bodies, 6)
}

/** A tool of the engine, which gives cycles as numbers: struct Cycle of apps/web/engine/tool.h. */
interface EngineTool {
  facts(): ToolFacts;
  place(positions: readonly number[]): Float64Array;
  follow(...hand: readonly number[]): Float64Array;
  step(...asked: readonly number[]): Float64Array;
  clearance(body: number): number;
  planes(): Plane[];
  delete(): void;
}

/** A tool that keepout constrains beside an anatomy: an instrument at a port, else the ball of a tip. */
export class Tool {
  readonly facts: ToolFacts;
  readonly subject: Subject;
  /** The tool of the engine, whose owner deletes it. */
  readonly made: EngineTool;

  constructor(keepout: Keepout, anatomy: Anatomy, settings: ToolSettings, port: Port | null) {
    this.made = keepout.makeTool(anatomy, { ...settings, ...spring, port });
    this.facts = this.made.facts();
    this.subject = port === null ? "tip" : "instrument";
  }

  /** Puts the tip or the joints there, and forgets the past. */
  place(positions: readonly number[]): Cycle {
    return this.cycle(this.made.place(positions));
  }

  /** One control cycle towards the hand; of a tip as `keepout replay --closed-loop`. */
  follow({ place, turn }: Frame): Cycle {
    return this.cycle(this.made.follow(...place, ...turn));
  }

  /** One step (6): of a tip from a place by an increment, of an instrument by a twist of the flange. */
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
