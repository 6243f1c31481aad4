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
  const [dx, dy, dz] = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
  const low = from.map((value, axis) => Math.min(value, to[axis] as number)) as unknown as Vec3;
  const high = from.map((value, axis) => Math.max(value, to[axis] as number)) as unknown as Vec3;
  let first = Infinity;
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = [corners[i] as number, corners[i + 1] as number, corners[i + 2] as number];
    if (isBeside(0) || isBeside(1) || isBeside(2)) continue;
    // Möller and Trumbore (1997).
    const [ux, uy, uz] = [at(b, 0) - at(a, 0), at(b, 1) - at(a, 1), at(b, 2) - at(a, 2)];
    const [vx, vy, vz] = [at(c, 0) - at(a, 0), at(c, 1) - at(a, 1), at(c, 2) - at(a, 2)];
    const [px, py, pz] = [dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx];
    const scale = 1 / (ux * px + uy * py + uz * pz);
    const [sx, sy, sz] = [from[0] - at(a, 0), from[1] - at(a, 1), from[2] - at(a, 2)];
    const u = scale * (sx * px + sy * py + sz * pz);
    const [qx, qy, qz] = [sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux];
    const v = scale * (dx * qx + dy * qy + dz * qz);
    const t = scale * (vx * qx + vy * qy + vz * qz);
    if (u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t <= 1) first = Math.min(first, t);

    function isBeside(axis: number): boolean {
      const [x, y, z] = [at(a, axis), at(b, axis), at(c, axis)];
      return (
        Math.max(x, y, z) < (low[axis] as number) || Math.min(x, y, z) > (high[axis] as number)
      );
    }
  }
  if (first === Infinity) return null;
  return [from[0] + first * dx, from[1] + first * dy, from[2] + first * dz];
}
