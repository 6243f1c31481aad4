// SPDX-License-Identifier: BSD-3-Clause
import type { Anatomy, Cycle, Frame, Tool, Vec3 } from "../engine/keepout.ts";

/** The places of an instrument and its hand relative to the surface, besides distances. */
export interface Surroundings {
  /**
   * The body that meets the surface or is in it, the point of its core there, and the nearest point
   * of the surface.
   */
  readonly contact: {
    readonly body: number;
    readonly core: Vec3;
    readonly surface: Vec3;
  } | null;
  /** True if the surface is between the end of the jaw and the hand. */
  readonly isHandBehind: boolean;
  /** True if the surface is on almost all sides of the end of the jaw, as in a skull. */
  readonly isEnclosed: boolean;
}

/** The number of bodies before the jaws: shaft and wrist. */
export const firstJaw = 2;

const signs = [-1, 1] as const;
/** To the sides and the corners of a cube. */
const directions: readonly Vec3[] = [
  ...signs.flatMap((s): Vec3[] => [
    [s, 0, 0],
    [0, s, 0],
    [0, 0, s],
  ]),
  ...signs.flatMap((x) => signs.flatMap((y) => signs.map((z): Vec3 => [x, y, z]))),
];
/** The number of directions in which an enclosed point sees no surface, at most. */
const mostOpen = 2;
/** An interval between two such examinations, in calls. */
const rest = 15;

/** Looks for the surface around an instrument. */
export class SurroundingsFinder {
  private isEnclosed = false;
  private due = 0;

  /** `size`: the diagonal of the anatomy's box. [mm] */
  constructor(
    private readonly anatomy: Anatomy,
    private readonly size: number,
  ) {}

  find({ made }: Tool, cycle: Cycle, hand: Frame, clearances: readonly number[]): Surroundings {
    const { place } = cycle.flange;
    if (this.due-- <= 0) {
      this.due = rest;
      this.isEnclosed = this.sides(place) >= directions.length - mostOpen;
    }
    const body = reachedBody(cycle, clearances);
    const points = body < 0 ? [] : made.contact(body);
    const point = (from: number) => points.slice(from, from + 3) as unknown as Vec3;
    return {
      contact: points.length === 0 ? null : { body, core: point(0), surface: point(3) },
      isHandBehind: this.anatomy.isBetween(...place, ...hand.place),
      isEnclosed: this.isEnclosed,
    };
  }

  /** Returns the number of directions in which the surface is on the line from a place. */
  private sides(place: Vec3): number {
    return directions.filter((way) => {
      const far = place.map((value, i) => value + this.size * (way[i] as number));
      return this.anatomy.isBetween(...place, ...far);
    }).length;
  }
}

/**
 * Returns the body that is deepest in the surface. If all are outside, returns the body whose
 * clearance limits the motion, or -1.
 */
export function reachedBody(
  { byMesh, held, nearest }: Pick<Cycle, "byMesh" | "held" | "nearest">,
  clearances: readonly number[],
): number {
  const least = Math.min(...clearances);
  if (least < 0) return clearances.indexOf(least);
  if (!byMesh || held === 0) return -1;
  // Only the tip is guarded if the engine does not know the nearest body.
  return nearest >= 0 ? nearest : clearances.length - 1;
}
