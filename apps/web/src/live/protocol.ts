// SPDX-License-Identifier: BSD-3-Clause
/** Messages between the page and its worker, in which keepout runs. */
import type {
  Counterexample,
  Cycle,
  Findings,
  Frame,
  Plane,
  Port,
  Rule,
  StatusWords,
  Subject,
  ToolFacts,
  ToolSettings,
  Vec3,
} from "../engine/keepout.ts";
import type { CenteredSurface } from "../page/centered_surface.ts";
import type { PackedSurface } from "../page/embedded_surface.ts";
import type { Shading } from "../page/shading.ts";
import type { CycleClock } from "./cycle_clock.ts";
import type { Surroundings } from "./robot_surroundings.ts";
import type { StartLine } from "./start_place.ts";

/** A mesh that `keepout live` has put into the page: see apps/keepout/live. */
export interface EmbeddedMesh extends PackedSurface {
  readonly name: string;
  /** The argument MESH for `keepout replay`. */
  readonly command_name: string;
  readonly warnings: readonly string[];
  /** The start of an instrument: its port, and its joints. [mm, rad] */
  readonly start?: { readonly base: readonly number[]; readonly positions: readonly number[] };
  /** The digest that keepout computes, for the mesh of an instrument. */
  readonly digest?: string;
}

/** The source of an anatomy. */
export type Source =
  | { readonly kind: "embedded"; readonly mesh: EmbeddedMesh; readonly data: string }
  | { readonly kind: "shape"; readonly name: string }
  | {
      readonly kind: "file";
      readonly name: string;
      readonly bytes: Uint8Array;
      /** Multiplies all coordinates: 1000 for a file in meters. */
      readonly scale: number;
    };

export type ToWorker =
  /** The engine in the page: base64 of gzip. */
  | { readonly kind: "start"; readonly engine: string; readonly subject: Subject }
  | {
      readonly kind: "load";
      readonly source: Source;
      readonly settings: ToolSettings;
      readonly port: Port | null;
    }
  | { readonly kind: "settings"; readonly settings: ToolSettings }
  /** Computes how a surface takes the light; needs no engine. See page/shading.ts. */
  | {
      readonly kind: "shade";
      readonly positions: Float32Array;
      readonly corners: Uint32Array;
      readonly creases: boolean;
    }
  /** Places the tip or the joints; starts a new path. */
  | { readonly kind: "place"; readonly positions: readonly number[] }
  /** Places a tip on one of these lines, at a distance from the anatomy: see startPlace(). [mm] */
  | {
      readonly kind: "place on a line";
      readonly lines: readonly StartLine[];
      readonly wanted: number;
      readonly least: number;
    }
  /** The hand; null: it is released, and the spring pulls it to the tool. */
  | { readonly kind: "hand"; readonly hand: Frame | null }
  /** Repeats a recorded path: see path_record.ts. `isHeld`: true if the hand stays at its end. */
  | { readonly kind: "replay"; readonly lines: Float64Array; readonly isHeld: boolean }
  /** Sends each cycle to a follower that listens to this port, and has this rule; null: to none. */
  | { readonly kind: "lead"; readonly port: MessagePort | null; readonly rule: Rule }
  /** Gives the follower another rule; the path starts anew on both sides. */
  | { readonly kind: "rule of the follower"; readonly rule: Rule }
  /** Runs the cycles that arrive at this port. */
  | { readonly kind: "follow"; readonly port: MessagePort }
  | { readonly kind: "ask for path"; readonly use: "save" | "replay" }
  | { readonly kind: "ask for counterexamples" }
  /** The simulation pauses while the page is hidden. */
  | { readonly kind: "pause"; readonly paused: boolean };

/** The function that handles messages of each kind. */
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

/** The last cycle and a summary of those before, sent about sixty times a second. */
export interface State extends Cycle, Pick<CycleClock, "lost" | "stepTime" | "rate"> {
  /** The worker's clock at the last cycle. [ms] */
  readonly time: number;
  readonly hand: Frame;
  /**
   * Distance of each body's surface from the mesh; for a tip below 0 inside, NaN if unknown. [mm]
   */
  readonly clearances: readonly number[];
  /**
   * The same for a ball at the hand, with the radius of the last body. It is below 0 as well if the
   * surface is between an instrument and its hand. [mm]
   */
  readonly handClearance: number;
  /** The surroundings of an instrument; null for a tip. */
  readonly surroundings: Surroundings | null;
  /** The planes that limit the motion of a tip. */
  readonly planes: readonly Plane[];
  /** The number of cycles since the anatomy was loaded, and of those that were limited. */
  readonly cycles: number;
  readonly limited: number;
  /** Motions of a tip through an open surface since it was placed, and where; beside another tool only. */
  readonly crossings: number;
  /** The number of times that the tool was placed. */
  readonly placed: number;
  readonly crossedAt: Vec3 | null;
}

export type FromWorker =
  | {
      readonly kind: "ready";
      readonly shapes: readonly string[];
      readonly statuses: readonly StatusWords[];
    }
  | ({ readonly kind: "surface"; readonly name: string } & CenteredSurface)
  | { readonly kind: "shaded"; readonly shading: Shading }
  | { readonly kind: "findings"; readonly findings: Findings }
  /** The index is built: a tool can be placed. */
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
  /** A replay has ended; `differs`: the first cycle with another tool position, or -1. */
  | { readonly kind: "replayed"; readonly cycles: number; readonly differs: number }
  | {
      readonly kind: "counterexamples";
      readonly margin: number;
      /**
       * `ends`: the ends of a step under the rule of Li et al. (2020), and under the certified
       * rule, and their distances from the surface.
       */
      readonly examples: readonly {
        example: Counterexample;
        ends: readonly { place: Vec3; clearance: number }[];
      }[];
    }
  /** The settings that stay in force when others were rejected. */
  | { readonly kind: "settings"; readonly settings: ToolSettings }
  /** `of`: the kind of the failed message. */
  | { readonly kind: "failure"; readonly of: ToWorker["kind"]; readonly message: string };
