// SPDX-License-Identifier: BSD-3-Clause
import type { Vec3 } from "../engine/keepout.ts";

/** The vertices (n, 3) and corners (m, 3) of a surface. */
export interface Triangles {
  readonly vertices: ArrayLike<number>;
  readonly corners: ArrayLike<number>;
}

/**
 * Returns where a straight motion meets a surface for the first time, or null. Examines all triangles, with no part
 * of keepout, so that a page can judge what a rule has done.
 */
export function crossing({ vertices, corners }: Triangles, from: Vec3, to: Vec3): Vec3 | null {
  const at = (corner: number, axis: number) => vertices[3 * corner + axis] as number;
  const motion = minus(to, from);
  let first = Infinity;
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = [corners[i] as number, corners[i + 1] as number, corners[i + 2] as number];
    // Most triangles are beside the motion along x.
    const [x, y, z] = [at(a, 0), at(b, 0), at(c, 0)];
    if (Math.max(x, y, z) < Math.min(from[0], to[0])) continue;
    if (Math.min(x, y, z) > Math.max(from[0], to[0])) continue;
    const [p, q, r] = [a, b, c].map((n): Vec3 => [at(n, 0), at(n, 1), at(n, 2)]) as [
      Vec3,
      Vec3,
      Vec3,
    ];
    first = Math.min(first, shareAt(from, motion, p, q, r));
  }
  if (first === Infinity) return null;
  return from.map((value, axis) => value + first * (motion[axis] as number)) as unknown as Vec3;
}

/** Returns the fraction of a motion at which it meets a triangle, or infinity: Möller and Trumbore (1997). */
function shareAt(from: Vec3, motion: Vec3, a: Vec3, b: Vec3, c: Vec3): number {
  const [first, second, start] = [minus(b, a), minus(c, a), minus(from, a)];
  const across = cross(motion, second);
  const scale = 1 / dot(first, across);
  const turned = cross(start, first);
  const [u, v, share] = [
    scale * dot(start, across),
    scale * dot(motion, turned),
    scale * dot(second, turned),
  ] as Vec3;
  return u >= 0 && v >= 0 && u + v <= 1 && share >= 0 && share <= 1 ? share : Infinity;
}

const minus = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
