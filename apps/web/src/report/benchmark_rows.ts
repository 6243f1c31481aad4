// SPDX-License-Identifier: BSD-3-Clause
import { entries, type Timing, valueAt } from "./record.ts";
import { inUnit, shown, trimmed } from "./shown.ts";

/** A row of a benchmark: one combination on one mesh. */
export interface BenchmarkRow {
  /** Where it is in the record. */
  readonly from: string;
  readonly mesh: string;
  readonly triangles: number;
  readonly vertices: number;
  readonly radius: number | null;
  readonly index: string;
  readonly activation: string;
  readonly solver: string;
  readonly build_s: number;
  readonly bytes_per_triangle: number;
  readonly planes_mean: number;
  readonly collect_us: Timing | null;
  readonly query_us: Timing | null;
  readonly step_query_us: Timing | null;
  readonly activate_us: Timing | null;
  readonly solve_us: Timing | null;
  readonly step_us: Timing | null;
  readonly rate_khz: number | null;
}

/** What there is to see in some rows. */
export interface Finding {
  readonly about: string;
  readonly mesh?: string | null;
  readonly rows: readonly number[];
}

/** Findings of one mesh, and where it is of one sphere, of that: they are drawn together. */
export interface FindingGroup {
  /** Their texts, in the record. */
  readonly texts: readonly string[];
  readonly rows: readonly BenchmarkRow[];
}

/** A benchmark of the record at `from`. */
export class BenchmarkRecord {
  readonly rows: readonly BenchmarkRow[];

  constructor(readonly from: string) {
    this.rows = entries(`${from}/rows`).map((row) => ({
      ...(valueAt(row) as BenchmarkRow),
      from: row,
    }));
  }

  /** What was found about something, mesh by mesh; `apart`: each sphere by itself, too. */
  found(about: string, apart = false): FindingGroup[] {
    const groups = new Map<string, { texts: string[]; rows: BenchmarkRow[] }>();
    for (const from of entries(`${this.from}/findings`)) {
      const finding = valueAt(from) as Finding;
      const rows = finding.rows.flatMap((number) => this.rows[number] ?? []);
      if (finding.about !== about || rows.length === 0) continue;
      const key = JSON.stringify([finding.mesh, apart ? rows[0]?.radius : null]);
      const group = groups.get(key) ?? { texts: [], rows: [] };
      group.texts.push(`${from}/text`);
      group.rows.push(...rows);
      groups.set(key, group);
    }
    return [...groups.values()];
  }
}

/** Whether rows are of meshes of several sizes, so that there is a line to draw. */
export const hasSizes = (rows: readonly BenchmarkRow[]): boolean =>
  new Set(rows.map(({ triangles }) => triangles)).size > 1;

/** What a row combines. */
export const combination = ({ index, activation, solver }: BenchmarkRow): string =>
  [index, activation, solver].join(", ");

/** The combination of the row at a pointer, shown as of the record. */
export const shownCombination = (from: string): (Node | string)[] => [
  shown(`${from}/index`),
  ", ",
  shown(`${from}/activation`),
  ", ",
  shown(`${from}/solver`),
];

/** What rows of findings have in common: the mesh, and the motion sphere where each is `apart`. */
export function nameOf([first]: readonly BenchmarkRow[], apart: boolean): (Node | string)[] {
  const mesh = shown(`${first?.from}/mesh`);
  if (!apart) return [mesh];
  if (first?.radius === null) return [mesh, ", as far as the motion leads"];
  return [mesh, ", motion sphere of ", shown(`${first?.from}/radius`, inUnit("mm", trimmed))];
}

/** How often a step fits into a second, on a mesh of this size. */
export interface Rate {
  readonly from: string;
  readonly triangles: number;
  readonly vertices: number;
  readonly series: string;
  /** In kHz, and under which key it is in the record. */
  readonly rate: number;
  readonly key: "rate_khz" | "khz";
}
