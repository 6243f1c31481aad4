// SPDX-License-Identifier: BSD-3-Clause
import { entries, type Timing, valueAt } from "./record.ts";
import { type Format, shown } from "./shown.ts";

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
  /** The rows of each. */
  readonly lines: readonly (readonly BenchmarkRow[])[];
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
    const groups = new Map<string, { texts: string[]; lines: BenchmarkRow[][] }>();
    for (const from of entries(`${this.from}/findings`)) {
      const finding = valueAt(from) as Finding;
      if (finding.about !== about) continue;
      const rows = finding.rows.flatMap((number) => this.rows[number] ?? []);
      const key = JSON.stringify([finding.mesh, apart ? rows[0]?.radius : null]);
      const group = groups.get(key) ?? { texts: [], lines: [] };
      group.texts.push(`${from}/text`);
      group.lines.push(rows);
      groups.set(key, group);
    }
    return [...groups.values()].map((group) => ({ ...group, rows: group.lines.flat() }));
  }
}

/** Whether rows are of meshes of several sizes, so that there is a line to draw. */
export const hasSizes = (rows: readonly BenchmarkRow[]): boolean =>
  new Set(rows.map(({ triangles }) => triangles)).size > 1;

/** What a row combines. */
export const combination = ({ index, activation, solver }: BenchmarkRow): string =>
  [index, activation, solver].join(", ");

/** The same, shown as of the record. */
export const shownCombination = ({ from }: BenchmarkRow): (Node | string)[] => [
  shown(`${from}/index`),
  ", ",
  shown(`${from}/activation`),
  ", ",
  shown(`${from}/solver`),
];

const reach: Format = (mm) => `${Number(mm.toPrecision(6))}\u00a0mm`;

/** The motion sphere of a row. */
export const shownSphere = ({ from, radius }: BenchmarkRow): (Node | string)[] =>
  radius === null
    ? ["as far as the motion leads"]
    : ["motion sphere of ", shown(`${from}/radius`, reach)];
