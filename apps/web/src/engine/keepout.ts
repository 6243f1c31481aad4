// SPDX-License-Identifier: BSD-3-Clause
/**
 * keepout itself, compiled to WebAssembly: apps/web/engine/exports.cpp says what each export does.
 * Lengths are in mm, forces in N, coordinates in the frame of the mesh.
 */

export type Vec3 = readonly [x: number, y: number, z: number];

/** What emscripten's module offers of which anything here makes use. */
export interface Module {
  readonly HEAPU8: Uint8Array;
  readonly HEAPU32: Uint32Array;
  readonly HEAPF64: Float64Array;
  readonly FS: {
    writeFile(path: string, bytes: Uint8Array): void;
    unlink(path: string): void;
  };
  _malloc(bytes: number): number;
  _free(address: number): void;
  _keepout_failure(): number;
  _keepout_shapes(): number;
  _keepout_counterexamples(): number;
  _keepout_status_name(status: number): number;
  _keepout_status_reason(status: number, subject: number): number;
  _keepout_anatomy_of_surface(
    vertices: number,
    vertexCount: number,
    corners: number,
    triangleCount: number,
  ): number;
  _keepout_anatomy_of_file(path: number): number;
  _keepout_anatomy_of_shape(name: number): number;
  _keepout_discard_anatomy(anatomy: number): void;
  _keepout_vertex_count(anatomy: number): number;
  _keepout_vertices(anatomy: number): number;
  _keepout_triangle_count(anatomy: number): number;
  _keepout_corners(anatomy: number): number;
  _keepout_findings(anatomy: number): number;
  _keepout_clearance(anatomy: number, x: number, y: number, z: number): number;
  _keepout_make_guard(
    anatomy: number,
    rule: number,
    radius: number,
    toolRadius: number,
    margin: number,
    maxStep: number,
    stiffness: number,
    largestForce: number,
  ): number;
  _keepout_discard_guard(guard: number): void;
  _keepout_place(guard: number, x: number, y: number, z: number): void;
  _keepout_follow(guard: number, x: number, y: number, z: number): number;
  _keepout_step(
    guard: number,
    px: number,
    py: number,
    pz: number,
    dx: number,
    dy: number,
    dz: number,
  ): number;
}

/** What emscripten's loader makes a module of: build/wasm/keepout.mjs. */
export type ModuleFactory<M extends Module = Module> = (options: {
  wasmBinary: Uint8Array;
  locateFile: (name: string) => string;
}) => Promise<M>;

/** Which rule keeps the tool out; with "none" it goes wherever the hand leads. */
export type Rule = "none" | "all_faces" | "paper" | "certified";

/** How a guard behaves. */
export interface GuardSettings {
  readonly rule: Rule;
  /** Of the motion sphere: how far the tip may go in a cycle at most. [mm] */
  readonly radius: number;
  /** Of the ball around the tip that shall not touch the anatomy. [mm] */
  readonly toolRadius: number;
  /** Distance to keep beyond that. [mm] */
  readonly margin: number;
  /** How far a cycle leads the tool at most. [mm] */
  readonly maxStep: number;
}

/** The spring between hand and tool. */
export const spring = { stiffness: 1 /* N/mm */, largestForce: 4 /* N */ } as const;

/** A sheet {u : normal . u >= offset} of increments that a rule allows, and the triangle it is of. */
export interface Plane {
  readonly normal: Vec3;
  readonly offset: number;
  readonly triangle: number;
}

/** What came of a control cycle. */
export interface Cycle {
  /** Where the tool is now. [mm] */
  readonly tip: Vec3;
  /** How far it went. [mm] */
  readonly motion: Vec3;
  /** On the hand. [N] */
  readonly force: Vec3;
  /** From where the tip was to the surface; NaN where it is not known. [mm] */
  readonly distance: number;
  readonly status: number;
  readonly triangles: number;
  readonly planeCount: number;
  readonly activeCount: number;
}

/** What `keepout inspect` would say of a mesh. */
export interface Findings {
  readonly watertight: boolean;
  readonly size: Vec3;
  readonly warnings: readonly string[];
  readonly findings: readonly {
    readonly key: string;
    readonly count: number;
    readonly text: string;
    readonly advice: string;
  }[];
}

/** A small mesh, and a motion on which the paper's rule fails. */
export interface Counterexample {
  readonly name: string;
  readonly vertices: readonly Vec3[];
  readonly triangles: readonly Vec3[];
  readonly tip: Vec3;
  readonly desired: Vec3;
  readonly radius: number;
}

/** The engine, ready to be asked. What it refuses is thrown, in its own words. */
export class Keepout<M extends Module = Module> {
  /** Names of generated meshes. */
  readonly shapes: readonly string[];

  private constructor(readonly module: M) {
    this.shapes = JSON.parse(this.text(this.given(module._keepout_shapes())));
  }

  static async load<M extends Module>(
    make: ModuleFactory<M>,
    wasmBinary: Uint8Array,
  ): Promise<Keepout<M>> {
    // Nothing is looked for: the binary is here.
    return new Keepout(await make({ wasmBinary, locateFile: (name) => name }));
  }

  /** Returns all statuses by number, with their reasons for a tip or an instrument. */
  statuses(subject: "tip" | "instrument"): { name: string; reason: string }[] {
    const all = [];
    for (let i = 0; this.statusName(i) !== "unknown"; ++i) {
      all.push({ name: this.statusName(i), reason: this.statusReason(i, subject) });
    }
    return all;
  }

  counterexamples(): Counterexample[] {
    return JSON.parse(this.text(this.given(this.module._keepout_counterexamples())));
  }

  statusName(status: number): string {
    return this.text(this.module._keepout_status_name(status));
  }

  private statusReason(status: number, subject: "tip" | "instrument"): string {
    return this.text(this.module._keepout_status_reason(status, subject === "tip" ? 0 : 1));
  }

  /** Of a surface that is welded already: (n, 3) coordinates and (m, 3) numbers of vertices. */
  anatomyOfSurface(vertices: Float64Array, corners: Uint32Array): Anatomy {
    const { module } = this;
    const vertexPlace = this.allocate(vertices.byteLength);
    const cornerPlace = this.allocate(corners.byteLength);
    try {
      module.HEAPF64.set(vertices, vertexPlace / 8);
      module.HEAPU32.set(corners, cornerPlace / 4);
      return this.anatomy(
        module._keepout_anatomy_of_surface(
          vertexPlace,
          vertices.length / 3,
          cornerPlace,
          corners.length / 3,
        ),
      );
    } finally {
      module._free(vertexPlace);
      module._free(cornerPlace);
    }
  }

  /** Of the bytes of a mesh file, whose name tells the format: STL, PLY, OBJ or OFF. */
  anatomyOfFile(name: string, bytes: Uint8Array): Anatomy {
    this.module.FS.writeFile(name, bytes);
    try {
      return this.withText(name, (text) =>
        this.anatomy(this.module._keepout_anatomy_of_file(text)),
      );
    } finally {
      this.module.FS.unlink(name);
    }
  }

  /** Of a generated mesh. */
  anatomyOfShape(name: string): Anatomy {
    return this.withText(name, (text) => this.anatomy(this.module._keepout_anatomy_of_shape(text)));
  }

  guard(anatomy: Anatomy, settings: GuardSettings): Guard {
    const address = this.withText(settings.rule, (rule) =>
      this.module._keepout_make_guard(
        anatomy.address,
        rule,
        settings.radius,
        settings.toolRadius,
        settings.margin,
        settings.maxStep,
        spring.stiffness,
        spring.largestForce,
      ),
    );
    return new Guard(this, this.given(address));
  }

  /** The text at an address, up to its end. */
  text(address: number): string {
    const heap = this.module.HEAPU8;
    return new TextDecoder().decode(heap.slice(address, heap.indexOf(0, address)));
  }

  private anatomy(address: number): Anatomy {
    return new Anatomy(this, this.given(address));
  }

  /** An address; what is none is a failure, which the engine has words for. */
  given(address: number): number {
    if (address === 0) throw new Error(this.text(this.module._keepout_failure()));
    return address;
  }

  allocate(bytes: number): number {
    const place = this.module._malloc(bytes);
    if (place === 0) throw new Error("there is not enough memory for it");
    return place;
  }

  withText<T>(text: string, use: (address: number) => T): T {
    const bytes = new TextEncoder().encode(`${text}\0`);
    const place = this.allocate(bytes.length);
    try {
      this.module.HEAPU8.set(bytes, place);
      return use(place);
    } finally {
      this.module._free(place);
    }
  }
}

/** A mesh and its index, which all guards on it share. */
export class Anatomy {
  constructor(
    private readonly keepout: Keepout,
    readonly address: number,
  ) {}

  /** (n, 3): a view that holds until the engine's memory grows. [mm] */
  get vertices(): Float64Array {
    const { module } = this.keepout;
    const begin = module._keepout_vertices(this.address) / 8;
    return module.HEAPF64.subarray(begin, begin + 3 * module._keepout_vertex_count(this.address));
  }

  /** (m, 3): numbers of vertices; a view, likewise. */
  get corners(): Uint32Array {
    const { module } = this.keepout;
    const begin = module._keepout_corners(this.address) / 4;
    return module.HEAPU32.subarray(begin, begin + 3 * module._keepout_triangle_count(this.address));
  }

  findings(): Findings {
    return JSON.parse(
      this.keepout.text(this.keepout.given(this.keepout.module._keepout_findings(this.address))),
    );
  }

  /** To the surface; below 0 inside a watertight mesh. [mm] */
  clearance(place: Vec3): number {
    return this.keepout.module._keepout_clearance(this.address, ...place);
  }

  discard(): void {
    this.keepout.module._keepout_discard_anatomy(this.address);
  }
}

/** What keeps the tool out of an anatomy. */
export class Guard {
  private last = 0;

  constructor(
    private readonly keepout: Keepout,
    private readonly address: number,
  ) {}

  /** Puts the tool there and forgets the past, as `keepout replay` begins. */
  place(tip: Vec3): void {
    this.keepout.module._keepout_place(this.address, ...tip);
    this.last = 0;
  }

  /** One control cycle towards a goal: what `keepout replay --closed-loop` does. */
  follow(goal: Vec3): Cycle {
    this.last = this.keepout.module._keepout_follow(this.address, ...goal);
    return this.cycle();
  }

  /** One step from a place: what `keepout replay` does without a closed loop. */
  step(tip: Vec3, desired: Vec3): Cycle {
    this.last = this.keepout.module._keepout_step(this.address, ...tip, ...desired);
    return this.cycle();
  }

  /** The planes that hold back the motion of the last cycle, copied. */
  activePlanes(): Plane[] {
    if (this.last === 0) return [];
    const { HEAPU32, HEAPF64 } = this.keepout.module;
    const counts = this.last / 4 + 20;
    const planeCount = HEAPU32[counts + 2] as number;
    const planes = (HEAPU32[counts + 4] as number) / 8;
    const active = (HEAPU32[counts + 5] as number) / 4;
    return [...HEAPU32.subarray(active, active + (HEAPU32[counts + 3] as number))]
      .filter((number) => number < planeCount)
      .map((number) => {
        const at = planes + 5 * number;
        const [x, y, z, offset] = HEAPF64.subarray(at, at + 4) as unknown as number[];
        return {
          normal: [x, y, z] as unknown as Vec3,
          offset: offset as number,
          triangle: HEAPU32[2 * (at + 4)] as number,
        };
      });
  }

  discard(): void {
    this.keepout.module._keepout_discard_guard(this.address);
  }

  private cycle(): Cycle {
    const { HEAPU32, HEAPF64 } = this.keepout.module;
    const at = this.last / 8;
    const vec3 = (from: number): Vec3 => [
      HEAPF64[from] as number,
      HEAPF64[from + 1] as number,
      HEAPF64[from + 2] as number,
    ];
    const counts = this.last / 4 + 20;
    return {
      tip: vec3(at),
      motion: vec3(at + 3),
      force: vec3(at + 6),
      distance: HEAPF64[at + 9] as number,
      status: HEAPU32[counts] as number,
      triangles: HEAPU32[counts + 1] as number,
      planeCount: HEAPU32[counts + 2] as number,
      activeCount: HEAPU32[counts + 3] as number,
    };
  }
}
