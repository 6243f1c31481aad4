// SPDX-License-Identifier: BSD-3-Clause
/** What the page with an instrument and its worker tell each other. */

import type { Findings } from "../engine/keepout.ts";
import type { Frame, InstrumentFacts, InstrumentStart } from "../engine/manipulator.ts";
import type { DrawnSurface } from "./drawn_surface.ts";
import type { EmbeddedMesh } from "./protocol.ts";
import type { LoopState, StatusWords } from "./status_line.ts";

/** A mesh, and where the instrument begins there. */
export interface InstrumentMesh extends EmbeddedMesh {
  readonly start: InstrumentStart;
  /** Of the mesh, as keepout has it. */
  readonly digest: string;
}

/** What `keepout live --robot` has put into the page beside the meshes. */
export interface InstrumentPage {
  readonly keepout: string;
  readonly robot: string;
  readonly margin: number;
  readonly max_step: number;
  readonly meshes: readonly InstrumentMesh[];
}

export type ToInstrument =
  /** The engine, as the page holds it, and what the page was made with. */
  | { readonly kind: "start"; readonly engine: string; readonly page: InstrumentPage }
  | {
      readonly kind: "load";
      readonly mesh: InstrumentMesh;
      readonly data: string;
      readonly margin: number;
    }
  | { readonly kind: "margin"; readonly margin: number }
  /** Where it was placed, it begins again. */
  | { readonly kind: "begin anew" }
  /** Where the flange is wanted; null: let go. */
  | { readonly kind: "hand"; readonly hand: Frame | null }
  | { readonly kind: "replay"; readonly lines: Float64Array }
  | { readonly kind: "ask for path"; readonly use: "save" | "replay" }
  | { readonly kind: "pause"; readonly paused: boolean };

/** What the last cycles came to: told some sixty times a second. */
export interface InstrumentState extends LoopState {
  readonly hand: Frame;
  readonly flange: Frame;
  /** Both ends of each body's axis: (bodies, 6). [mm] */
  readonly cores: readonly number[];
  /** From the surface of each body to the mesh, to a twentieth of a millimetre or so. [mm] */
  readonly clearances: readonly number[];
  /** From the nearest one, as the engine has it; NaN where none is near. [mm] */
  readonly distance: number;
  readonly nearest: number;
  /** From where the hand wants the tip of the last body to the mesh; below 0 inside. [mm] */
  readonly handClearance: number;
  readonly rows: number;
  readonly rounds: number;
}

export type FromInstrument =
  | { readonly kind: "ready"; readonly statuses: readonly StatusWords[] }
  | ({ readonly kind: "surface" } & DrawnSurface)
  | { readonly kind: "findings"; readonly findings: Findings }
  | { readonly kind: "placed"; readonly facts: InstrumentFacts }
  | { readonly kind: "state"; readonly state: InstrumentState }
  | { readonly kind: "path"; readonly use: "save" | "replay"; readonly lines: Float64Array }
  /** A replay has come to its end; `differs`: the first cycle that went another way, or -1. */
  | { readonly kind: "replayed"; readonly cycles: number; readonly differs: number }
  | { readonly kind: "failure"; readonly message: string };
