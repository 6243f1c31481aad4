// SPDX-License-Identifier: BSD-3-Clause
import type * as three from "three";
import type { Lengths } from "./painting.ts";

/** The widths of paths in a picture. [px] */
export const widths = { faint: 1, many: 1.7, whole: 2.2, near: 3.4 } as const;

/**
 * Returns the segments between neighbors of a path, as pairs of ends. Places nearer than `least`
 * count as one.
 */
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

/**
 * Returns paths in their color where they are good, and in the alarm color, visible through the
 * surface, where they are bad.
 */
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

/** Splits a path into good and bad segments, by its good and bad cycles. */
export function parted(
  path: readonly three.Vector3[],
  isBad: readonly boolean[],
  least: number,
): { good: number[]; bad: number[] } {
  const result = { good: [] as number[], bad: [] as number[] };
  // A move into or out of a bad cycle counts as bad.
  const isBadMove = (i: number) => isBad[i] === true || isBad[i - 1] === true;
  for (let first = 1, i = 1; i < path.length; ++i) {
    if (i + 1 < path.length && isBadMove(i + 1) === isBadMove(first)) continue;
    const kind = isBadMove(first) ? result.bad : result.good;
    for (const value of ends(path.slice(first - 1, i + 1), least)) kind.push(value);
    first = i + 1;
  }
  return result;
}
