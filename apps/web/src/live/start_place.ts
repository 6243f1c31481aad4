// SPDX-License-Identifier: BSD-3-Clause
import type { Vec3 } from "../engine/keepout.ts";

/** A line on which a tip may start, from a place outside the anatomy. [mm] */
export interface StartLine {
  readonly from: Vec3;
  readonly to: Vec3;
}

/** The most distances that are measured on a line. */
const mostSteps = 200;
/** The intervals in which a line is sampled, if its beginning is not outside. */
const samples = 40;

/**
 * Returns the first place on one of these lines, from its beginning, where the distance from the
 * anatomy has fallen to `wanted`. If no line has such a place, returns the place with the largest
 * distance, if that is at least `least`; else null. [mm]
 */
export function startPlace(
  lines: readonly StartLine[],
  distance: (...place: Vec3) => number,
  wanted: number,
  least: number,
): Vec3 | null {
  let best: { place: Vec3; distance: number } | null = null;
  for (const { from, to } of lines) {
    const length = Math.hypot(...to.map((value, i) => value - (from[i] as number)));
    const placeAt = (along: number) =>
      from.map(
        (value, i) => value + (along / length) * ((to[i] as number) - value),
      ) as unknown as Vec3;
    // No surface is nearer than the distance, so each advance by the excess stays outside.
    for (let step = 0, along = 0; step < mostSteps && along <= length; ++step) {
      const place = placeAt(along);
      const here = distance(...place);
      if (Number.isNaN(here) || here < 0) break;
      const excess = here - wanted;
      if (step > 0 && excess < 0.01 * wanted) return place;
      if (excess < 0) break;
      along += Math.max(excess, 0.002 * wanted);
    }
    for (let sample = 0; sample <= samples; ++sample) {
      const place = placeAt((sample / samples) * length);
      const here = distance(...place);
      if (here >= least && here > (best?.distance ?? 0)) best = { place, distance: here };
    }
  }
  return best?.place ?? null;
}
