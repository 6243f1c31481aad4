// SPDX-License-Identifier: BSD-3-Clause
import type { Vec3 } from "../engine/keepout.ts";

/** What to draw of a mesh: (n, 3) coordinates from `origin` on, and (m, 3) corners. */
export interface DrawnSurface {
  readonly name: string;
  readonly origin: Vec3;
  readonly positions: Float32Array<ArrayBuffer>;
  readonly corners: Uint32Array<ArrayBuffer>;
}

/** What is drawn are floats: of coordinates from the middle on, which are small. */
export function drawnSurface(
  name: string,
  vertices: Float64Array,
  corners: Uint32Array,
): DrawnSurface {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < vertices.length; ++i) {
    const value = vertices[i] as number;
    const axis = i % 3;
    if (value < (low[axis] as number)) low[axis] = value;
    if (value > (high[axis] as number)) high[axis] = value;
  }
  const origin = low.map((value, i) => 0.5 * (value + (high[i] as number))) as unknown as Vec3;
  const positions = Float32Array.from(vertices, (value, i) => value - (origin[i % 3] as number));
  return { name, origin, positions, corners: new Uint32Array(corners) };
}
