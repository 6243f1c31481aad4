// SPDX-License-Identifier: BSD-3-Clause
/**
 * keepout itself, compiled to WebAssembly: apps/web/engine/exports.cpp says what each export does.
 * Lengths are in mm, forces in N, coordinates in the frame of the mesh.
 */
import { type Port, type Subject, spring, Tool, type ToolSettings } from "./tool.ts";

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
  _keepout_statuses(subject: number): number;
  _keepout_anatomy_of_surface(
    vertices: number,
    vertexCount: number,
    corners: number,
    triangleCount: number,
  ): number;
  _keepout_anatomy_of_file(path: number): number;
  _keepout_anatomy_of_shape(name: number): number;
  _keepout_discard_anatomy(anatomy: number): void;
  _keepout_surface(anatomy: number): number;
  _keepout_findings(anatomy: number): number;
  _keepout_clearance(anatomy: number, x: number, y: number, z: number): number;
  _keepout_make_tip(anatomy: number, rule: number, settings: number): number;
  _keepout_make_instrument(anatomy: number, robot: number, settings: number): number;
  _keepout_discard_tool(tool: number): void;
  _keepout_tool_facts(tool: number): number;
  _keepout_place(tool: number, positions: number): number;
  _keepout_follow(tool: number, hand: number): number;
  _keepout_step(tool: number, asked: number): number;
  _keepout_body_clearance(tool: number, body: number): number;
}

/** What emscripten's loader makes a module of: build/wasm/keepout.mjs. */
export type ModuleFactory = (options: {
  wasmBinary: Uint8Array;
  locateFile: (name: string) => string;
}) => Promise<Module>;

/** What `keepout inspect` would say of a mesh. */
export interface Findings {
  readonly watertight: boolean;
  readonly size: Vec3;
  readonly warnings: readonly string[];
  readonly findings: readonly { readonly text: string; readonly advice: string }[];
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
export class Keepout {
  /** Names of generated meshes. */
  readonly shapes: readonly string[];

  private constructor(readonly module: Module) {
    this.shapes = this.json(module._keepout_shapes());
  }

  static async load(make: ModuleFactory, wasmBinary: Uint8Array): Promise<Keepout> {
    // Nothing is looked for: the binary is here.
    return new Keepout(await make({ wasmBinary, locateFile: (name) => name }));
  }

  /** Returns all statuses by number, with their reasons for a tip or an instrument. */
  statuses(subject: Subject): { name: string; reason: string }[] {
    return this.json(this.module._keepout_statuses(subject === "tip" ? 0 : 1));
  }

  counterexamples(): Counterexample[] {
    return this.json(this.module._keepout_counterexamples());
  }

  /** Of a surface that is welded already: (n, 3) coordinates and (m, 3) numbers of vertices. */
  anatomyOfSurface(vertices: Float64Array, corners: Uint32Array): Anatomy {
    return this.withCopy(vertices, (from) =>
      this.withCopy(corners, (to) =>
        this.anatomy(
          this.module._keepout_anatomy_of_surface(
            from,
            vertices.length / 3,
            to,
            corners.length / 3,
          ),
        ),
      ),
    );
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

  /** Makes an instrument at a port, or the ball of a tip if there is no port. */
  tool(anatomy: Anatomy, settings: ToolSettings, port: Port | null): Tool {
    const { rule, radius, toolRadius, margin, maxStep } = settings;
    const [kind, name, numbers] =
      port === null
        ? ([
            "tip",
            rule,
            [radius, toolRadius, margin, maxStep, spring.stiffness, spring.largestForce],
          ] as const)
        : (["instrument", port.robot, [...port.base, margin, maxStep]] as const);
    const address = this.withText(name, (text) =>
      this.withNumbers(numbers, (place) =>
        this.module[`_keepout_make_${kind}`](anatomy.address, text, place),
      ),
    );
    return new Tool(this, this.given(address), kind);
  }

  /** What the JSON at an address says. */
  json<T>(address: number): T {
    return JSON.parse(this.text(this.given(address)));
  }

  /** The text at an address, up to its end. */
  private text(address: number): string {
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

  /** Runs what needs a text in the engine's memory. */
  private withText<T>(text: string, use: (address: number) => T): T {
    return this.withCopy(new TextEncoder().encode(`${text}\0`), use);
  }

  /** Runs what needs numbers in the engine's memory. */
  withNumbers<T>(numbers: readonly number[], use: (address: number) => T): T {
    return this.withCopy(Float64Array.from(numbers), use);
  }

  private withCopy<T>(of: ArrayBufferView, use: (address: number) => T): T {
    const place = this.module._malloc(of.byteLength);
    if (place === 0) throw new Error("there is not enough memory for it");
    try {
      this.module.HEAPU8.set(new Uint8Array(of.buffer, of.byteOffset, of.byteLength), place);
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

  /** Coordinates (n, 3) [mm] and numbers of vertices (m, 3): views until the engine's memory grows. */
  get surface(): { vertices: Float64Array; corners: Uint32Array } {
    const { HEAPU32, HEAPF64, _keepout_surface } = this.keepout.module;
    const at = _keepout_surface(this.address) / 4;
    const [vertices, vertexCount, corners, triangleCount] = HEAPU32.subarray(
      at,
      at + 4,
    ) as unknown as readonly [number, number, number, number];
    return {
      vertices: HEAPF64.subarray(vertices / 8, vertices / 8 + 3 * vertexCount),
      corners: HEAPU32.subarray(corners / 4, corners / 4 + 3 * triangleCount),
    };
  }

  findings(): Findings {
    return this.keepout.json(this.keepout.module._keepout_findings(this.address));
  }

  /** To the surface; below 0 inside a watertight mesh. [mm] */
  clearance(place: Vec3): number {
    return this.keepout.module._keepout_clearance(this.address, ...place);
  }

  discard(): void {
    this.keepout.module._keepout_discard_anatomy(this.address);
  }
}
