// SPDX-License-Identifier: BSD-3-Clause
import type { ToolSettings, Vec3 } from "../engine/keepout.ts";

/** A motion of the hand behind an open surface, where the rule of Li et al. (2020) lets the tool through. */
export interface WallStroke {
  /** The anatomy: its name on a command line. */
  readonly mesh: string;
  /** The hand goes straight from each place to the next one. [mm] */
  readonly way: readonly Vec3[];
  /** The target of the camera, its direction from there, and the length that it shows. [mm] */
  readonly target: Vec3;
  readonly direction: Vec3;
  readonly length: number;
  readonly toolRadius: number;
  readonly begin: string;
  readonly why: string;
}

const oneSide =
  "Li et al.’s rule guards the front of a surface: it adds no plane for a tip behind it, where an open mesh lets the " +
  "tool in. The certified rule guards both sides.";

/** The best one first. */
export const wallStrokes: readonly WallStroke[] = [
  {
    mesh: "aneurysm",
    way: [
      [10.7, -29.2, 41.2],
      [9.1, -15.7, 36.1],
      [2.4, -14.6, 41.2],
    ],
    target: [7, -18, 39],
    direction: [-0.75, -0.75, 0.5],
    length: 26,
    toolRadius: 0.5,
    begin:
      "The hand goes into the sample aneurysm at its open end. Then it pushes at the wall, from inside.",
    why: oneSide,
  },
  {
    mesh: "tunnel",
    way: [
      [0, -38, 10],
      [0, -15, 10],
    ],
    target: [0, -25, 10],
    direction: [0.3, 0.6, 1],
    length: 56,
    toolRadius: 1,
    begin:
      "The anatomy is now a sample mesh: a tube, whose wall faces inwards. The hand pushes at it from outside.",
    why: `${oneSide} The tube is a sample mesh: “One scene” goes back to your anatomy.`,
  },
];

/** The settings of a stroke, for both tools. */
export const settingsOf = ({ toolRadius }: WallStroke): Partial<ToolSettings> => ({
  toolRadius,
  margin: 0.2,
  radius: 5,
  guides: [],
});

/** The motion of the hand in a cycle, and its rest at the beginning. [mm], [cycles] */
const speed = 0.006;
const rest = 300;

/** Returns the path of a stroke as lines of a recorded path: see path_record.ts. */
export function linesOf({ way }: WallStroke): Float64Array {
  const start = way[0] as Vec3;
  const lines: number[] = [];
  const add = (place: readonly number[]) => lines.push(...place, ...start);
  for (let i = 0; i < rest; ++i) add(start);
  way.slice(1).forEach((to, i) => {
    const from = way[i] as Vec3;
    const steps = Math.ceil(
      Math.hypot(...to.map((value, k) => value - (from[k] as number))) / speed,
    );
    for (let step = 1; step <= steps; ++step) {
      add(from.map((value, k) => value + (step / steps) * ((to[k] as number) - value)));
    }
  });
  return Float64Array.from(lines);
}
