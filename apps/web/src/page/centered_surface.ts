// SPDX-License-Identifier: BSD-3-Clause
import type { Vec3 } from "../engine/keepout.ts";

/**
 * A surface to draw: (n, 3) coordinates relative to the middle of its box, `origin`, and (m, 3)
 * corners.
 */
export interface CenteredSurface {
  readonly origin: Vec3;
  /** The diagonal of its box. [mm] */
  readonly size: number;
  readonly positions: Float32Array<ArrayBuffer>;
  readonly corners: Uint32Array<ArrayBuffer>;
}

/** Returns a copy in floats, relative to the middle: small coordinates lose little by rounding. */
export function centered(vertices: Float64Array, corners: Uint32Array): CenteredSurface {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < vertices.length; ++i) {
    const value = vertices[i] as number;
    const axis = i % 3;
    if (value < (low[axis] as number)) low[axis] = value;
    if (value > (high[axis] as number)) high[axis] = value;
  }
  const origin = low.map((value, i) => 0.5 * (value + (high[i] as number))) as unknown as Vec3;
  const size = Math.hypot(...low.map((value, i) => (high[i] as number) - value));
  const positions = Float32Array.from(vertices, (value, i) => value - (origin[i % 3] as number));
  return { origin, size, positions, corners: new Uint32Array(corners) };
}
