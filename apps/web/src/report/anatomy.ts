// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { type CenteredSurface, centered } from "../page/centered_surface.ts";
import { decodeSurface } from "../page/embedded_surface.ts";
import { type Shading, shade } from "../page/shading.ts";
import { type Tissue, tissueOf } from "../page/tissue.ts";
import type { Place, RecordedMesh } from "./simulation_record.ts";

/** The mesh of a record, relative to the middle of its box. */
export interface Anatomy extends CenteredSurface {
  readonly isClosed: boolean;
  readonly tissue: Tissue;
  /** Computed in pauses, after the first pictures. */
  readonly shading: Promise<Shading>;
  /** Converts a place of the record to such a position. */
  readonly placed: (place: Place) => three.Vector3;
}

/** Unpacks the mesh of a record. */
export async function unpackedAnatomy(mesh: RecordedMesh): Promise<Anatomy> {
  const { vertices, corners } = await decodeSurface(mesh.drawn, mesh.drawn.packed);
  const surface = centered(vertices, corners);
  const middle = new three.Vector3(...surface.origin);
  const tissue = tissueOf(mesh.name);
  return {
    ...surface,
    isClosed: mesh.surface === "closed",
    tissue,
    shading: inPauses(shade(surface.positions, surface.corners, tissue.creases)),
    placed: (place) => new three.Vector3(...place).sub(middle),
  };
}

/** Does a work in parts of some milliseconds, between which the page answers to the user. */
async function inPauses<Result>(work: Generator<void, Result>): Promise<Result> {
  for (;;) {
    await new Promise((done) => setTimeout(done));
    const end = performance.now() + 12;
    do {
      const { done, value } = work.next();
      if (done) return value;
    } while (performance.now() < end);
  }
}

/**
 * Returns the corners of triangles near a line: at least one corner is within a distance of the
 * line through a place along a direction, and not beyond the front.
 */
export function cornersAround(
  { positions, corners }: Anatomy,
  place: three.Vector3,
  along: three.Vector3,
  reach: number,
  front: number,
): Uint32Array {
  const isNear = new Uint8Array(positions.length / 3);
  const way = new three.Vector3();
  for (let i = 0; i < isNear.length; ++i) {
    way.fromArray(positions, 3 * i);
    const isBefore = way.dot(along) > front;
    way.sub(place);
    isNear[i] = Number(!isBefore && way.lengthSq() - way.dot(along) ** 2 <= reach ** 2);
  }
  return corners.filter((_, i) => {
    const first = i - (i % 3);
    return [0, 1, 2].some((k) => isNear[corners[first + k] as number]);
  });
}

/** Returns the corners of fewer triangles: vertices in the same cube of a grid count as one. */
export function coarsened(
  positions: Float32Array,
  corners: Uint32Array,
  grain: number,
): Uint32Array {
  const first = new Map<number, number>();
  const cell = (vertex: number, axis: number) =>
    Math.round((positions[3 * vertex + axis] as number) / grain) + 2 ** 16;
  const merged = new Uint32Array(positions.length / 3).map((_, vertex) => {
    const key = (cell(vertex, 0) * 2 ** 17 + cell(vertex, 1)) * 2 ** 17 + cell(vertex, 2);
    const known = first.get(key);
    if (known === undefined) first.set(key, vertex);
    return known ?? vertex;
  });
  const result: number[] = [];
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map(
      (k) => merged[corners[i + k] as number] as number,
    ) as unknown as Corners;
    if (a !== b && b !== c && c !== a) result.push(a, b, c);
  }
  return new Uint32Array(result);
}

type Corners = readonly [number, number, number];

/**
 * Returns the mean direction out of the surface around a place, weighted by area; null without a
 * surface.
 */
export function outward(
  { positions, corners }: Anatomy,
  place: three.Vector3,
  radius: number,
): three.Vector3 | null {
  const sum = new three.Vector3();
  const triangle = new three.Triangle();
  const { a, b, c } = triangle;
  const middle = new three.Vector3();
  for (let i = 0; i < corners.length; i += 3) {
    a.fromArray(positions, 3 * (corners[i] as number));
    b.fromArray(positions, 3 * (corners[i + 1] as number));
    c.fromArray(positions, 3 * (corners[i + 2] as number));
    if (triangle.getMidpoint(middle).distanceToSquared(place) > radius ** 2) continue;
    sum.addScaledVector(triangle.getNormal(middle), triangle.getArea());
  }
  return sum.lengthSq() > 0 ? sum.normalize() : null;
}

/** The view of the anatomy: a camera without perspective, with a target. */
export interface Outlook {
  readonly camera: three.OrthographicCamera;
  readonly target: three.Vector3;
}

/** Width to height of all pictures. */
export const aspect = 4 / 3;

/** Views a target from a direction. `height`: the visible height. [mm] */
export function lookFrom(
  toward: three.Vector3,
  up: three.Vector3,
  target: three.Vector3,
  height: number,
  size: number,
): Outlook {
  const [x, y] = [(aspect * height) / 2, height / 2];
  const camera = new three.OrthographicCamera(-x, x, y, -y, 0, 6 * size);
  camera.up.copy(up).normalize();
  camera.position
    .copy(toward)
    .normalize()
    .multiplyScalar(3 * size)
    .add(target);
  camera.lookAt(target);
  camera.updateMatrixWorld();
  return { camera, target: target.clone() };
}

/** The vertices of an anatomy. */
export const verticesOf = ({ positions }: Anatomy): three.Vector3[] =>
  Array.from({ length: positions.length / 3 }, (_, i) =>
    new three.Vector3().fromArray(positions, 3 * i),
  );

/** Views places from a direction, with a multiple of the height that shows them all. */
export function lookAtAll(
  places: readonly three.Vector3[],
  toward: three.Vector3,
  up: three.Vector3,
  { size }: Anatomy,
  height = 1.13,
): Outlook {
  const { middle, height: least } = fitted(places, toward, up);
  return lookFrom(toward, up, middle, height * least, size);
}

/** Returns the middle of places, and the height that shows them all from a direction. */
export function fitted(
  places: readonly three.Vector3[],
  toward: three.Vector3,
  up: three.Vector3,
): { middle: three.Vector3; height: number } {
  const axes = new three.Matrix4().lookAt(toward, new three.Vector3(), up);
  const inverse = axes.clone().invert();
  const box = new three.Box3();
  const turned = new three.Vector3();
  for (const place of places) box.expandByPoint(turned.copy(place).applyMatrix4(inverse));
  const { x, y } = box.getSize(new three.Vector3());
  const middle = box.getCenter(new three.Vector3()).applyMatrix4(axes);
  return { middle, height: Math.max(y, x / aspect) };
}
