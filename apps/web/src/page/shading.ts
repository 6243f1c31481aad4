// SPDX-License-Identifier: BSD-3-Clause
/** How a surface takes the light. This is for drawing only: no vertex moves. */

/** For each vertex of a surface. */
export interface Shading {
  /** Normals, three coordinates each; zero at a sharp edge, where each triangle has its own. */
  readonly normals: Float32Array<ArrayBuffer>;
  /** The share of the surrounding light that reaches the vertex: 0 none, 255 all. */
  readonly ambience: Uint8Array<ArrayBuffer>;
}

/** The cells of the grid of occupied space, along the longest side of the surface's box. */
const cells = 120;
/** The directions from which light comes, over the whole sphere. */
const directions = 40;
/**
 * The places where a ray of light is tested, in cells, and their grid. A grid has cells that are twice as
 * large as those of the one before, so that no ray jumps over a thin wall.
 */
const stops = [2.2, 3.2, 4.2, 6, 8, 12, 16, 20];
const gridOfStop = [0, 0, 0, 1, 1, 2, 2, 2];
/** The passes that smooth normals; each reaches one triangle farther. */
const passes = 6;
/** A vertex is at a sharp edge if a triangle is turned away from its normal: by this cosine. */
const sharpest = 0.85;
/** The number of triangles or vertices between two pauses. */
const slice = 20_000;

/**
 * Computes the shading of a surface: (n, 3) coordinates and (m, 3) corners. Pauses (yields) after
 * some milliseconds of work. `creases`: keeps sharp edges, because the surface has true ones; else
 * the steps of a CT scan disappear.
 */
export function* shade(
  positions: Float32Array,
  corners: Uint32Array,
  creases: boolean,
): Generator<void, Shading> {
  let normals = new Float32Array(positions.length);
  yield* overTriangles(corners, (a, b, c) => addNormal(positions, normals, a, b, c));
  normalize(normals);
  for (let pass = 0; pass < (creases ? 0 : passes); ++pass) {
    const from = normals;
    const sums = from.slice();
    yield* overTriangles(corners, (a, b, c) => {
      for (let k = 0; k < 3; ++k) {
        const all = (from[a + k] as number) + (from[b + k] as number) + (from[c + k] as number);
        sums[a + k] = (sums[a + k] as number) + all;
        sums[b + k] = (sums[b + k] as number) + all;
        sums[c + k] = (sums[c + k] as number) + all;
      }
    });
    normalize(sums);
    normals = sums;
  }
  const light = yield* lightAt(positions, corners, normals);
  const bends = yield* bendsOf(positions, corners, normals);
  if (creases) yield* clearEdges(positions, corners, normals);
  const ambience = new Uint8Array(light.length).map((_, i) => {
    const bend = bends[i] as number;
    return 255 * Math.min(1, (light[i] as number) * (0.9 + (bend < 0 ? 0.35 : 0.1) * bend));
  });
  return { normals, ambience };
}

type ForTriangle = (a: number, b: number, c: number) => void;

/** Calls a function with the offsets of the corners of each triangle; with pauses. */
function* overTriangles(corners: Uint32Array, act: ForTriangle): Generator<void, void> {
  for (let i = 0; i < corners.length; i += 3) {
    act(3 * (corners[i] as number), 3 * (corners[i + 1] as number), 3 * (corners[i + 2] as number));
    if (i % (3 * slice) === 0) yield;
  }
}

/** Adds the normal of a triangle, as long as twice its area, to those of its corners. */
function addNormal(p: Float32Array, normals: Float32Array, a: number, b: number, c: number): void {
  const at = (i: number) => p[i] as number;
  const [ux, uy, uz] = [at(b) - at(a), at(b + 1) - at(a + 1), at(b + 2) - at(a + 2)];
  const [vx, vy, vz] = [at(c) - at(a), at(c + 1) - at(a + 1), at(c + 2) - at(a + 2)];
  const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  for (const to of [a, b, c]) {
    normals[to] = (normals[to] as number) + x;
    normals[to + 1] = (normals[to + 1] as number) + y;
    normals[to + 2] = (normals[to + 2] as number) + z;
  }
}

/** Clears the normals of vertices at sharp edges. */
function* clearEdges(
  positions: Float32Array,
  corners: Uint32Array,
  normals: Float32Array,
): Generator<void, void> {
  const kept = normals.slice();
  const own = new Float32Array(9);
  const places = new Float32Array(9);
  yield* overTriangles(corners, (...triangle) => {
    triangle.forEach((corner, i) => {
      places.set(positions.subarray(corner, corner + 3), 3 * i);
    });
    own.fill(0);
    addNormal(places, own, 0, 3, 6);
    normalize(own);
    for (const corner of triangle) {
      let along = 0;
      for (let k = 0; k < 3; ++k) along += (own[k] as number) * (kept[corner + k] as number);
      if (along < sharpest) normals.fill(0, corner, corner + 3);
    }
  });
}

function normalize(vectors: Float32Array): void {
  for (let i = 0; i < vectors.length; i += 3) {
    const [x, y, z] = [vectors[i] as number, vectors[i + 1] as number, vectors[i + 2] as number];
    const length = Math.sqrt(x * x + y * y + z * z) || 1;
    vectors[i] = x / length;
    vectors[i + 1] = y / length;
    vectors[i + 2] = z / length;
  }
}

/** A grid of cells that the surface passes through. */
interface Grid {
  readonly counts: readonly number[];
  readonly taken: Uint8Array;
}

/** Returns the grid with cells of twice the size. */
function coarser({ counts, taken }: Grid): Grid {
  const [across, down] = counts as [number, number, number];
  const halves = counts.map((count) => (count + 1) >> 1);
  const [wide, high] = halves as [number, number, number];
  const found = new Uint8Array(halves.reduce((all, count) => all * count, 1));
  for (let i = 0; i < taken.length; ++i) {
    if (taken[i] === 0) continue;
    const [x, row] = [i % across, Math.floor(i / across)];
    const [y, z] = [row % down, Math.floor(row / down)];
    found[((z >> 1) * high + (y >> 1)) * wide + (x >> 1)] = 1;
  }
  return { counts: halves, taken: found };
}

/** Returns grids from fine to coarse, their lowest corner, and the side of the finest cells. [mm] */
function* gridsOf(
  positions: Float32Array,
  corners: Uint32Array,
): Generator<void, { grids: Grid[]; low: number[]; cell: number }> {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    const value = positions[i] as number;
    const axis = i % 3;
    if (value < (low[axis] as number)) low[axis] = value;
    if (value > (high[axis] as number)) high[axis] = value;
  }
  const sides = high.map((value, axis) => value - (low[axis] as number));
  const cell = Math.max(...sides) / cells || 1;
  const counts = sides.map((side) => Math.floor(side / cell) + 1);
  const [across, down] = counts as [number, number, number];
  const taken = new Uint8Array(counts.reduce((all, count) => all * count, 1));
  const p = positions;
  const mix = (a: number, b: number, c: number, axis: number, u: number, v: number) => {
    const [pa, pb, pc] = [p[a + axis] as number, p[b + axis] as number, p[c + axis] as number];
    return Math.floor((pa + u * (pb - pa) + v * (pc - pa) - (low[axis] as number)) / cell);
  };
  yield* overTriangles(corners, (a, b, c) => {
    let longest = 0;
    for (let axis = 0; axis < 3; ++axis) {
      const [pa, pb, pc] = [p[a + axis] as number, p[b + axis] as number, p[c + axis] as number];
      longest = Math.max(longest, Math.max(pa, pb, pc) - Math.min(pa, pb, pc));
    }
    const parts = Math.ceil(longest / cell) + 1;
    for (let i = 0; i <= parts; ++i) {
      for (let k = 0; k <= parts - i; ++k) {
        const [u, v] = [i / parts, k / parts];
        const z = mix(a, b, c, 2, u, v);
        taken[(z * down + mix(a, b, c, 1, u, v)) * across + mix(a, b, c, 0, u, v)] = 1;
      }
    }
  });
  const grids: Grid[] = [{ counts, taken }];
  for (let i = 0; i < 2; ++i) grids.push(coarser(grids[i] as Grid));
  return { grids, low, cell };
}

/** Returns how much light from all around reaches each vertex, from 0 to 1. */
function* lightAt(
  positions: Float32Array,
  corners: Uint32Array,
  normals: Float32Array,
): Generator<void, Float32Array> {
  const { grids, low, cell } = yield* gridsOf(positions, corners);
  const tests = stops.map((t, i) => {
    const level = gridOfStop[i] as number;
    const { counts, taken } = grids[level] as Grid;
    const [across, down, up] = counts as [number, number, number];
    return { t, size: 2 ** level, loss: 1 - t / 28, across, down, up, taken };
  });
  // Evenly over the sphere, along a spiral.
  const rays = Array.from({ length: directions }, (_, i) => {
    const z = 1 - (2 * i + 1) / directions;
    const [flat, turn] = [Math.sqrt(1 - z * z), 2.399963 * i];
    return [flat * Math.cos(turn), flat * Math.sin(turn), z] as const;
  });
  const light = new Float32Array(positions.length / 3);
  for (let i = 0; i < light.length; ++i) {
    if (i % slice === 0) yield;
    const [nx, ny, nz] = [0, 1, 2].map((k) => normals[3 * i + k] as number) as number[] &
      [number, number, number];
    // In cells, from a little above the surface.
    const [x, y, z] = [0, 1, 2].map(
      (k) =>
        ((positions[3 * i + k] as number) - (low[k] as number)) / cell +
        0.8 * (normals[3 * i + k] as number),
    ) as number[] & [number, number, number];
    let [all, lost] = [0, 0];
    for (const [dx, dy, dz] of rays) {
      const along = dx * nx + dy * ny + dz * nz;
      if (along < 0.3) continue; // the surface itself would be in the way
      all += along;
      for (const { t, size, loss, across, down, up, taken } of tests) {
        const a = Math.floor((x + t * dx) / size);
        const b = Math.floor((y + t * dy) / size);
        const c = Math.floor((z + t * dz) / size);
        if (a < 0 || b < 0 || c < 0 || a >= across || b >= down || c >= up) break;
        if (taken[(c * down + b) * across + a] === 0) continue;
        lost += along * loss;
        break;
      }
    }
    light[i] = 1 - lost / (all || 1);
  }
  return light;
}

/** Returns how each vertex bends: -1 in a valley, 1 on a ridge. */
function* bendsOf(
  positions: Float32Array,
  corners: Uint32Array,
  normals: Float32Array,
): Generator<void, Float32Array> {
  const sums = new Float32Array(positions.length / 3);
  const counts = new Uint16Array(sums.length);
  let extent = 0;
  for (const value of positions) extent = Math.max(extent, Math.abs(value));
  const scale = 0.02 * extent;
  const edge = (a: number, b: number) => {
    let [along, length] = [0, 0];
    for (let k = 0; k < 3; ++k) {
      const way = (positions[b + k] as number) - (positions[a + k] as number);
      along += way * ((normals[b + k] as number) - (normals[a + k] as number));
      length += way * way;
    }
    const bend = length > 0 ? (scale * along) / Math.max(length, 1e-3 * scale * scale) : 0;
    for (const to of [a / 3, b / 3]) {
      sums[to] = (sums[to] as number) + bend;
      counts[to] = (counts[to] as number) + 1;
    }
  };
  yield* overTriangles(corners, (a, b, c) => {
    edge(a, b);
    edge(b, c);
    edge(c, a);
  });
  return sums.map((sum, i) => Math.max(-1, Math.min(1, sum / Math.max(counts[i] as number, 1))));
}
