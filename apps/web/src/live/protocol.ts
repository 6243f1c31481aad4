// SPDX-License-Identifier: BSD-3-Clause
/** Messages between the page and its worker, in which keepout runs. */
import type {
  Counterexample,
  Cycle,
  Findings,
  Frame,
  Plane,
  Port,
  StatusWords,
  Subject,
  ToolFacts,
  ToolSettings,
  Vec3,
} from "../engine/keepout.ts";
import type { CenteredSurface } from "../page/centered_surface.ts";
import type { PackedSurface } from "../page/embedded_surface.ts";
import type { CycleClock } from "./cycle_clock.ts";

/** A mesh that `keepout live` has put into the page: see apps/keepout/live. */
export interface EmbeddedMesh extends PackedSurface {
  readonly name: string;
  /** What to give to `keepout replay` as MESH. */
  readonly command_name: string;
  readonly warnings: readonly string[];
  /** Where an instrument begins: its port, and its joints. [mm, rad] */
  readonly start?: { readonly base: readonly number[]; readonly positions: readonly number[] };
  /** Of the mesh of an instrument, as keepout has it. */
  readonly digest?: string;
}

/** Where an anatomy comes from. */
export type Source =
  | { readonly kind: "embedded"; readonly mesh: EmbeddedMesh; readonly data: string }
  | { readonly kind: "shape"; readonly name: string }
  | { readonly kind: "file"; readonly name: string; readonly bytes: Uint8Array };

export type ToWorker =
  /** The engine, as the page holds it: base64 of gzip. */
  | { readonly kind: "start"; readonly engine: string; readonly subject: Subject }
  | {
      readonly kind: "load";
      readonly source: Source;
      readonly settings: ToolSettings;
      readonly port: Port | null;
    }
  | { readonly kind: "settings"; readonly settings: ToolSettings }
  /** The tip or the joints are put there, and a new path begins. */
  | { readonly kind: "place"; readonly positions: readonly number[] }
  /** Where the hand is; null: it lets go, and the spring draws it to the tool. */
  | { readonly kind: "hand"; readonly hand: Frame | null }
  /** Repeats a recorded path: see path_record.ts. */
  | { readonly kind: "replay"; readonly lines: Float64Array }
  | { readonly kind: "ask for path"; readonly use: "save" | "replay" }
  | { readonly kind: "ask for counterexamples" }
  /** Time stands still while nobody looks. */
  | { readonly kind: "pause"; readonly paused: boolean };

/** What to do with messages of each kind. */
export type Handlers<Message extends { readonly kind: string }> = {
  readonly [Kind in Message["kind"]]: (
    message: Extract<Message, { kind: Kind }>,
  ) => void | Promise<void>;
};

/** Handles a message. */
export const handled = <Message extends { readonly kind: string }>(
  handlers: Handlers<Message>,
  message: Message,
): void | Promise<void> => handlers[message.kind as Message["kind"]](message as never);

/** The last cycle, and those before it: told some sixty times a second. */
export interface State extends Cycle, Pick<CycleClock, "lost" | "stepTime" | "rate"> {
  /** Of the worker's clock, at the last cycle. [ms] */
  readonly time: number;
  readonly hand: Frame;
  /** From each body's surface to the mesh; of a tip below 0 inside, NaN where unknown. [mm] */
  readonly clearances: readonly number[];
  /** The same of the last body's radius where the hand is. [mm] */
  readonly handClearance: number;
  /** Those that limit the motion of a tip. */
  readonly planes: readonly Plane[];
  /** All cycles since the anatomy was loaded, and those in which something limited the motion. */
  readonly cycles: number;
  readonly limited: number;
}

export type FromWorker =
  | {
      readonly kind: "ready";
      readonly shapes: readonly string[];
      readonly statuses: readonly StatusWords[];
    }
  | ({ readonly kind: "surface"; readonly name: string } & CenteredSurface)
  | { readonly kind: "findings"; readonly findings: Findings }
  /** The index is built: the tool can be placed. */
  | { readonly kind: "guarded" }
  /** A tool was made. */
  | { readonly kind: "tool"; readonly facts: ToolFacts }
  | { readonly kind: "state"; readonly state: State }
  | {
      readonly kind: "path";
      readonly use: "save" | "replay";
      readonly lines: Float64Array;
      readonly settings: ToolSettings;
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
  | { readonly kind: "settings"; readonly settings: ToolSettings }
  /** `of`: what was asked for. */
  | { readonly kind: "failure"; readonly of: ToWorker["kind"]; readonly message: string };
