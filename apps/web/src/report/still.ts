// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { hatching } from "../page/anatomy_material.ts";
import { colorOf } from "../page/color_of.ts";
import type { Anatomy } from "./anatomy.ts";
import { type Cut, restBehind } from "./cut.ts";
import type { Layer, Painter } from "./painting.ts";

/** A rendered surface: the picture, and the depths, from -1 to 1. */
interface Seen {
  readonly picture: ImageData;
  readonly depths: Float32Array;
}

const key = new three.Vector3(-0.45, 0.62, 0.64).normalize();

/** Converts linear light to a byte of a picture. */
const byte = (light: number): number => 255 * Math.min(1, light) ** (1 / 2.2);

/**
 * Draws a surface without WebGL, triangle by triangle, each in one color. `scale`: drawn pixels per
 * pixel of the page.
 */
export function seen(
  { positions, isClosed, tissue }: Anatomy,
  corners: Uint32Array,
  camera: three.OrthographicCamera,
  [width, height]: readonly [number, number],
  cut: Cut | null = null,
  scale = 1,
): Seen {
  const picture = new ImageData(width, height);
  const depths = new Float32Array(width * height).fill(1);
  const view = new three.Matrix4()
    .makeScale(width / 2, -height / 2, 1)
    .multiply(new three.Matrix4().makeTranslation(1, -1, 0))
    .multiply(camera.projectionMatrix)
    .multiply(camera.matrixWorldInverse);
  const places = new three.Float32BufferAttribute(positions, 3).applyMatrix4(view).array;
  const at = (corner: number, axis: number) => places[3 * corner + axis] as number;
  const rests = cut ? restBehind(cut, positions) : null;
  const triangle = new three.Triangle();
  const normal = new three.Vector3();
  const toEye = camera.quaternion.clone().invert();
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = [corners[i] as number, corners[i + 1] as number, corners[i + 2] as number];
    const [ax, ay, bx, by, cx, cy] = [at(a, 0), at(a, 1), at(b, 0), at(b, 1), at(c, 0), at(c, 1)];
    const left = Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5));
    const right = Math.min(width - 1, Math.floor(Math.max(ax, bx, cx) - 0.5));
    const top = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5));
    const bottom = Math.min(height - 1, Math.floor(Math.max(ay, by, cy) - 0.5));
    const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (left > right || top > bottom || area === 0) continue;
    const isFree = area < 0; // rows run downwards
    const isSection = cut !== null && isClosed && !isFree;
    triangle.a.fromArray(positions, 3 * a);
    triangle.b.fromArray(positions, 3 * b);
    triangle.c.fromArray(positions, 3 * c);
    triangle.getNormal(normal).applyQuaternion(toEye);
    if (!isFree) normal.negate();
    const light = 0.22 + 0.06 * normal.y + 0.86 * Math.max(0, (normal.dot(key) + 0.15) / 1.15);
    const [red, green, blue] = isFree ? tissue.base : tissue.hollow;
    for (let y = top; y <= bottom; ++y) {
      for (let x = left; x <= right; ++x) {
        const u = ((x + 0.5 - ax) * (cy - ay) - (cx - ax) * (y + 0.5 - ay)) / area;
        const v = ((bx - ax) * (y + 0.5 - ay) - (x + 0.5 - ax) * (by - ay)) / area;
        const w = 1 - u - v;
        const pixel = y * width + x;
        const depth = w * at(a, 2) + u * at(b, 2) + v * at(c, 2);
        // Draws slightly beyond the edge, so that there are no gaps between neighbors.
        if (Math.min(u, v, w) < -1e-4 || depth >= (depths[pixel] as number)) continue;
        if (
          rests &&
          w * (rests[a] as number) + u * (rests[b] as number) + v * (rests[c] as number) < 0
        )
          continue;
        depths[pixel] = depth;
        const lit = (x + y) % (scale * hatching.period) < scale * hatching.line ? 0.8 : 1;
        const [r, g, b_] = isSection ? tissue.section : [red, green, blue];
        const share = isSection ? lit : light;
        picture.data[4 * pixel] = byte(share * r);
        picture.data[4 * pixel + 1] = byte(share * g);
        picture.data[4 * pixel + 2] = byte(share * b_);
        picture.data[4 * pixel + 3] = 255;
      }
    }
  }
  return { picture, depths };
}

/** Draws without WebGL. */
export class StillPainter implements Painter {
  private readonly canvas = document.createElement("canvas");
  private last: Seen | null = null;

  /** `corners`: of the drawn triangles. */
  constructor(
    private readonly anatomy: Anatomy,
    private readonly corners: Uint32Array,
    private readonly camera: three.OrthographicCamera,
  ) {}

  outdate(): void {
    this.last = null;
  }

  // A triangle has one color.
  shade(): void {}

  dispose(): void {}

  paint(layer: Layer, width: number, height: number, scale: number): HTMLCanvasElement {
    const size = [Math.round(width * scale), Math.round(height * scale)] as const;
    const isOther = this.last?.picture.width !== size[0] || this.last.picture.height !== size[1];
    if (!this.last || isOther || layer.cut) {
      this.last = seen(this.anatomy, this.corners, this.camera, size, layer.cut, scale);
    }
    [this.canvas.width, this.canvas.height] = size;
    const pen = this.canvas.getContext("2d") as CanvasRenderingContext2D;
    pen.putImageData(this.last.picture, 0, 0);
    this.drawLines(pen, layer, this.last.depths, scale);
    this.drawBodies(pen, layer);
    return this.canvas;
  }

  /** Draws a body as a wide line with round ends, in every view. */
  private drawBodies(pen: CanvasRenderingContext2D, { bodies = [] }: Layer): void {
    const { width, height } = this.canvas;
    const { top, bottom, zoom } = this.camera;
    pen.lineCap = "round";
    for (const { from, to, radius, color } of bodies) {
      pen.beginPath();
      for (const place of [from, to]) {
        const { x, y } = place.clone().project(this.camera);
        pen.lineTo(((x + 1) * width) / 2, ((1 - y) * height) / 2);
      }
      pen.lineWidth = (2 * radius * zoom * height) / (top - bottom);
      pen.strokeStyle = colorOf(color);
      pen.stroke();
    }
  }

  private drawLines(
    pen: CanvasRenderingContext2D,
    { lengths }: Layer,
    depths: Float32Array,
    scale: number,
  ): void {
    const { width, height } = this.canvas;
    const { top, bottom, zoom, near, far } = this.camera;
    pen.lineCap = "round";
    for (const { ends, color, isSeenThrough, width: wide, opacity = 1 } of lengths) {
      const slack = (3 * wide * (top - bottom)) / (zoom * height * (far - near));
      const places = new three.Float32BufferAttribute(ends, 3)
        .applyMatrix4(this.camera.matrixWorldInverse)
        .applyMatrix4(this.camera.projectionMatrix);
      pen.beginPath();
      for (let i = 0; i < places.count; i += 2) {
        const [x, y] = [0, 1].map((k) => ((places.getX(i + k) + 1) * width) / 2) as [
          number,
          number,
        ];
        const [v, w] = [0, 1].map((k) => ((1 - places.getY(i + k)) * height) / 2) as [
          number,
          number,
        ];
        const middle = Math.floor((v + w) / 2) * width + Math.floor((x + y) / 2);
        if (!isSeenThrough && places.getZ(i) - slack > (depths[middle] ?? 1)) continue;
        pen.moveTo(x, v);
        pen.lineTo(y, w);
      }
      pen.globalAlpha = opacity;
      for (const [more, shade] of [
        [1.1, "#000a"],
        [0, colorOf(color)],
      ] as const) {
        pen.lineWidth = (wide + more) * scale;
        pen.strokeStyle = shade;
        pen.stroke();
      }
    }
    pen.globalAlpha = 1;
  }
}
