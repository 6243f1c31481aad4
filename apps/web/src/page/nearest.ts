// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";

/** The number of triangles in a block. */
const blockSize = 64;

/** The point of a surface that is nearest to another point. */
export interface Nearest {
  readonly point: three.Vector3;
  readonly distance: number;
}

/**
 * Finds the triangles of a surface near a point, for drawing. Triangles that follow each other in
 * the mesh form a block with a box.
 */
export class NearTriangles {
  /** The least x, y and z of each block, and the largest ones. */
  private readonly boxes: Float32Array;
  private readonly triangle = new three.Triangle();
  /** The triangle that was nearest last: at first the next one is often the same. */
  private last = 0;

  /** (n, 3) coordinates and (m, 3) corners. */
  constructor(
    private readonly positions: Float32Array,
    private readonly corners: Uint32Array,
  ) {
    const blocks = Math.ceil(corners.length / (3 * blockSize));
    this.boxes = new Float32Array(6 * blocks);
    for (let block = 0; block < blocks; ++block) {
      for (let axis = 0; axis < 3; ++axis) {
        let [low, high] = [Infinity, -Infinity];
        const end = Math.min(3 * blockSize * (block + 1), corners.length);
        for (let i = 3 * blockSize * block; i < end; ++i) {
          const value = positions[3 * (corners[i] as number) + axis] as number;
          if (value < low) low = value;
          if (value > high) high = value;
        }
        this.boxes[6 * block + axis] = low;
        this.boxes[6 * block + 3 + axis] = high;
      }
    }
  }

  /** Returns the nearest point of the surface; null without triangles. */
  nearest(to: three.Vector3): Nearest | null {
    if (this.corners.length === 0) return null;
    const point = new three.Vector3();
    const trial = new three.Vector3();
    let [best, found] = [Infinity, this.last];
    const look = (triangle: number) => {
      this.load(triangle).closestPointToPoint(to, trial);
      const square = trial.distanceToSquared(to);
      if (square >= best) return;
      best = square;
      found = triangle;
      point.copy(trial);
    };
    look(this.last);
    this.visit(to, () => best, look);
    this.last = found;
    return { point, distance: Math.sqrt(best) };
  }

  /** Calls a function for each triangle that may be within a distance of a point. */
  around(to: three.Vector3, reach: number, act: (triangle: three.Triangle) => void): void {
    this.visit(
      to,
      () => reach ** 2,
      (number) => act(this.load(number)),
    );
  }

  /** `most`: the square of the largest distance, which may become smaller meanwhile. */
  private visit(to: three.Vector3, most: () => number, act: (triangle: number) => void): void {
    const { boxes } = this;
    const { x, y, z } = to;
    for (let block = 0; block < boxes.length; block += 6) {
      const at = (i: number) => boxes[block + i] as number;
      const dx = Math.max(at(0) - x, 0, x - at(3));
      const dy = Math.max(at(1) - y, 0, y - at(4));
      const dz = Math.max(at(2) - z, 0, z - at(5));
      if (dx * dx + dy * dy + dz * dz > most()) continue;
      const first = (block / 6) * blockSize;
      const end = Math.min(first + blockSize, this.corners.length / 3);
      for (let triangle = first; triangle < end; ++triangle) act(triangle);
    }
  }

  private load(number: number): three.Triangle {
    const { triangle, corners, positions } = this;
    triangle.a.fromArray(positions, 3 * (corners[3 * number] as number));
    triangle.b.fromArray(positions, 3 * (corners[3 * number + 1] as number));
    triangle.c.fromArray(positions, 3 * (corners[3 * number + 2] as number));
    return triangle;
  }
}
