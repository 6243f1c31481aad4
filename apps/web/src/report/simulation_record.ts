// SPDX-License-Identifier: BSD-3-Clause
/** Anatomy and paths in the records of `simulate` and `plan`: docs/records.md. */

import type { PackedSurface } from "../page/embedded_surface.ts";
import { extremes } from "./extremes.ts";
import type { ReportRecord } from "./record.ts";

export type Place = readonly [number, number, number];
type Surface = "closed" | "open";

export interface RecordedMesh {
  readonly name: string;
  readonly surface: Surface;
  readonly drawn: PackedSurface & { readonly packed: string };
}

export interface Stroke {
  readonly tip: readonly Place[];
  readonly clearance_mm: readonly number[];
  readonly step_us: readonly number[];
  readonly outcome: string;
}

export interface Run {
  readonly rule: string;
  readonly name: string;
  readonly description: string;
  readonly kept_out: boolean;
  readonly strokes: readonly Stroke[];
  readonly worst: { readonly stroke: number; readonly cycle: number };
  readonly crossings: readonly { readonly stroke: number; readonly cycle: number }[];
}

/** A cycle of a stroke of a run, by their numbers. */
export interface Moment {
  readonly run: number;
  readonly stroke: number;
  readonly cycle: number;
}

export interface SimulationRecord extends ReportRecord {
  readonly mesh: RecordedMesh;
  readonly has_convex_tool?: boolean;
  readonly guides?: readonly string[];
  readonly kept_mm: number;
  readonly cycle_s: number;
  readonly up: Place;
  readonly hand: readonly (readonly Place[])[];
  readonly runs: readonly Run[];
  readonly moment: Moment;
}

export interface PlanRecord extends ReportRecord {
  readonly meshes: readonly (RecordedMesh & { readonly inside: boolean })[];
  readonly runs: readonly {
    readonly mesh: string;
    readonly checker: string;
    readonly path?: readonly Place[] | null;
    readonly too_near?: readonly (readonly Place[])[] | null;
  }[];
}

/**
 * Returns the cycles of a stroke in which the tip is at a forbidden place. For a closed surface:
 * inside it, or just after passing through it. For an open surface: beyond it, after an odd number
 * of crossings. For a convex tool: where it touches the surface. Unknown cycles count as bad.
 */
export function trespass(
  run: Run,
  stroke: number,
  { mesh, has_convex_tool }: Pick<SimulationRecord, "mesh" | "has_convex_tool">,
): readonly boolean[] {
  const surface: Surface = has_convex_tool ? "closed" : mesh.surface;
  const { clearance_mm } = run.strokes[stroke] as Stroke;
  const crossed = new Set(
    run.crossings.filter((one) => one.stroke === stroke).map(({ cycle }) => cycle),
  );
  let isPast = false;
  return clearance_mm.map((clearance: number | null, cycle) => {
    if (surface === "closed") return crossed.has(cycle) || clearance === null || clearance < 0;
    if (crossed.has(cycle)) isPast = !isPast;
    return isPast;
  });
}

/** Returns the number of the run under the certified rule, or else of the last run. */
export function bestRun(runs: readonly Run[]): number {
  const certified = runs.findIndex(({ rule }) => rule === "certified");
  return certified < 0 ? runs.length - 1 : certified;
}

/** Returns the deepest cycle of a stroke, or else its first crossing, or else its nearest cycle. */
export function worstCycle(run: Run, stroke: number): number {
  const { clearance_mm } = run.strokes[stroke] as Stroke;
  const [lowest] = extremes(clearance_mm);
  const crossing = run.crossings.find((one) => one.stroke === stroke);
  return lowest >= 0 && crossing ? crossing.cycle : clearance_mm.indexOf(lowest);
}

/**
 * Returns the most informative moment of a stroke: of a rule that failed, else of the run that came
 * nearest.
 */
export function tellingMoment(record: SimulationRecord, stroke: number): Moment {
  if (stroke === record.moment.stroke) return record.moment;
  const moments = record.runs.map((run, number) => {
    const cycle = worstCycle(run, stroke);
    const clearance = run.strokes[stroke]?.clearance_mm[cycle] as number;
    const isIn = clearance < 0 || run.crossings.some((crossing) => crossing.stroke === stroke);
    const kind = isIn ? (run.rule === "none" ? 1 : 2) : 0;
    return { run: number, stroke, cycle, kind, clearance };
  });
  moments.sort((a, b) => b.kind - a.kind || a.clearance - b.clearance);
  return moments[0] as Moment;
}
