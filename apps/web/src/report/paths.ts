// SPDX-License-Identifier: BSD-3-Clause
import type * as three from "three";
import type { Lengths } from "./painting.ts";

/** How wide paths are in a picture. [px] */
export const widths = { many: 1.7, whole: 2.2, near: 3.4 } as const;

/** What is between neighbours of a path, as pairs of ends; places nearer than `least` count as one. */
export function ends(path: readonly three.Vector3[], least = 0): number[] {
  const result: number[] = [];
  let last = path[0];
  path.forEach((place, i) => {
    if (i === 0 || !last) return;
    if (place.distanceTo(last) < least && i < path.length - 1) return;
    result.push(...last.toArray(), ...place.toArray());
    last = place;
  });
  return result;
}

/** Paths in a colour where all is well, and in that of alarm, seen through the surface, where not. */
export function coloured(
  good: readonly number[],
  bad: readonly number[],
  color: string,
  width: number,
  isSeenThrough = false,
): Lengths[] {
  return [
    { ends: new Float32Array(good), color, isAlarming: false, isSeenThrough, width },
    {
      ends: new Float32Array(bad),
      color: "--alarm",
      isAlarming: true,
      isSeenThrough: true,
      width: 1.3 * width,
    },
  ];
}

/** A path in the lengths that are good and those that are bad, by the cycles that are. */
export function parted(
  path: readonly three.Vector3[],
  isBad: readonly boolean[],
  least: number,
): { good: number[]; bad: number[] } {
  const result = { good: [] as number[], bad: [] as number[] };
  // The move that leads in or out belongs to what is drawn over the rest.
  const isBadMove = (i: number) => isBad[i] === true || isBad[i - 1] === true;
  for (let first = 1, i = 1; i < path.length; ++i) {
    if (i + 1 < path.length && isBadMove(i + 1) === isBadMove(first)) continue;
    const kind = isBadMove(first) ? result.bad : result.good;
    for (const value of ends(path.slice(first - 1, i + 1), least)) kind.push(value);
    first = i + 1;
  }
  return result;
}
