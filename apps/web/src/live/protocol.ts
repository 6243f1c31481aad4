// SPDX-License-Identifier: BSD-3-Clause
/** What the page and its worker, in which keepout runs, tell each other. */
import type { Counterexample, Findings, GuardSettings, Plane, Vec3 } from "../engine/keepout.ts";
import type { PackedSurface } from "../page/embedded_surface.ts";
import type { DrawnSurface } from "./drawn_surface.ts";
import type { LoopState, StatusWords } from "./status_line.ts";

/** A mesh that `keepout live` has put into the page: see apps/keepout/live. */
export interface EmbeddedMesh extends PackedSurface {
  readonly name: string;
  /** What to give to `keepout replay` as MESH. */
  readonly command_name: string;
  readonly warnings: readonly string[];
}

/** Of a path: ten minutes at 1 kHz. */
export const mostCycles = 600_000;

/** Where an anatomy comes from. */
export type Source =
  | { readonly kind: "embedded"; readonly mesh: EmbeddedMesh; readonly data: string }
  | { readonly kind: "shape"; readonly name: string }
  | { readonly kind: "file"; readonly name: string; readonly bytes: Uint8Array };

export type ToWorker =
  /** The engine, as the page holds it: base64 of gzip. */
  | { readonly kind: "start"; readonly engine: string }
  | { readonly kind: "load"; readonly source: Source; readonly settings: GuardSettings }
  | { readonly kind: "settings"; readonly settings: GuardSettings }
  /** The tool is put there, and a new path begins. */
  | { readonly kind: "place"; readonly tip: Vec3 }
  /** Where the hand is; null: it lets go, and the spring draws it to the tool. */
  | { readonly kind: "hand"; readonly place: Vec3 | null }
  /** Follows a recorded hand: (n, 6), as a path file has it. */
  | { readonly kind: "replay"; readonly lines: Float64Array }
  | { readonly kind: "ask for path"; readonly use: "save" | "replay" }
  | { readonly kind: "ask for counterexamples" }
  /** Time stands still while nobody looks. */
  | { readonly kind: "pause"; readonly paused: boolean };

/** What the last cycles came to: told some sixty times a second. */
export interface State extends LoopState {
  readonly tip: Vec3;
  readonly hand: Vec3;
  /** On the hand. [N] */
  readonly force: Vec3;
  /** From the ball of the tool to the surface; below 0 inside. NaN where unknown. [mm] */
  readonly toolClearance: number;
  /** The same of a ball as large where the hand is. [mm] */
  readonly handClearance: number;
  readonly planes: readonly Plane[];
  readonly planeCount: number;
  readonly triangles: number;
}

export type FromWorker =
  | {
      readonly kind: "ready";
      readonly shapes: readonly string[];
      readonly statuses: readonly StatusWords[];
    }
  | ({ readonly kind: "surface" } & DrawnSurface)
  | { readonly kind: "findings"; readonly findings: Findings }
  /** The index is built: the tool can be placed. */
  | { readonly kind: "guarded" }
  | { readonly kind: "state"; readonly state: State }
  | {
      readonly kind: "path";
      readonly use: "save" | "replay";
      readonly lines: Float64Array;
      readonly settings: GuardSettings;
    }
  /** A replay has come to its end; `differs`: the first cycle with another tool, or -1. */
  | { readonly kind: "replayed"; readonly cycles: number; readonly differs: number }
  | {
      readonly kind: "counterexamples";
      readonly margin: number;
      /** `ends`: where a step ends under the paper's rule, and under the certified one. */
      readonly examples: readonly { example: Counterexample; ends: readonly Vec3[] }[];
    }
  /** Those that stay in force, when others were refused. */
  | { readonly kind: "settings"; readonly settings: GuardSettings }
  /** `of`: what was asked for. */
  | { readonly kind: "failure"; readonly of: ToWorker["kind"]; readonly message: string };
