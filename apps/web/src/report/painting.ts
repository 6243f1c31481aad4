// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { anatomyMaterial } from "../page/anatomy_material.ts";
import { Capsule } from "../page/capsule.ts";
import { colorOf } from "../page/color_of.ts";
import { type Graphics, setShading, surfaceGeometry } from "../page/graphics.ts";
import type { Shading } from "../page/shading.ts";
import { StillPicture } from "../page/still_picture.ts";
import { type Anatomy, coarsened } from "./anatomy.ts";
import type { Cut } from "./cut.ts";
import { discard, Line, setUniforms } from "./line.ts";

/** Segments of paths with the same appearance. */
export interface Lengths {
  /** Pairs of ends, three coordinates each. */
  readonly ends: Float32Array;
  /** The variable of the page's style with the color. */
  readonly color: string;
  /** True for wide segments that are visible through the surface. */
  readonly isAlarming: boolean;
  readonly isSeenThrough: boolean;
  /** [px of the page] */
  readonly width: number;
  /** From 0 to 1; 1 if missing. */
  readonly opacity?: number;
}

/** A body of an instrument: a capsule between two places. */
export interface Body {
  readonly from: three.Vector3;
  readonly to: three.Vector3;
  /** [mm] */
  readonly radius: number;
  /** The variable of the page's style with the color. */
  readonly color: string;
  /** The opacity where the surface hides it, from 0 to 1. */
  readonly hidden: number;
}

/** The content of a picture besides the anatomy. */
export interface Layer {
  readonly lengths: readonly Lengths[];
  readonly cut: Cut | null;
  /** Bodies of an instrument, which differ between pictures. */
  bodies?: readonly Body[];
}

/** Draws the pictures of one anatomy. */
export interface Painter {
  /**
   * `scale`: drawn pixels per pixel of the page; below one if speed matters more than quality. The
   * result is valid until the next call.
   */
  paint(layer: Layer, width: number, height: number, scale: number): CanvasImageSource;
  /** Marks the view of the last picture as outdated. */
  outdate(): void;
  /** Refines the shading of the anatomy. */
  shade(shading: Shading): void;
  dispose(): void;
}

/** Draws with WebGL. */
export class GraphicsPainter implements Painter {
  private readonly anatomy: three.Mesh<three.BufferGeometry, three.ShaderMaterial>;
  private readonly scene = new three.Scene();
  private readonly still: StillPicture;
  private readonly linesOf = new Map<Layer, readonly Line[]>();
  private readonly capsules: Capsule[] = [];
  private readonly instrument = new three.Scene();
  private readonly depths = new three.DataTexture(null, 1, 1, three.RedFormat, three.FloatType);

  private readonly fine: three.BufferAttribute;
  private readonly coarse: three.BufferAttribute;
  private lastColumns = 0;

  /** `corners`: of the drawn triangles. `isCut`: true for each picture that cuts them open. */
  constructor(
    private readonly graphics: Graphics,
    anatomy: Anatomy,
    corners: Uint32Array,
    private readonly camera: three.OrthographicCamera,
    isCut: boolean,
  ) {
    const geometry = surfaceGeometry(anatomy.positions, corners);
    this.fine = geometry.index as three.BufferAttribute;
    const grain = (camera.top - camera.bottom) / 120;
    this.coarse = graphics.isSlow
      ? new three.BufferAttribute(coarsened(anatomy.positions, corners, grain), 1)
      : this.fine;
    const material = anatomyMaterial(
      anatomy.tissue,
      isCut ? { isClosed: anatomy.isClosed, depths: this.depths } : null,
    );
    this.anatomy = new three.Mesh(geometry, material);
    this.anatomy.frustumCulled = false;
    this.scene.add(this.anatomy);
    this.still = new StillPicture(this.scene, camera, graphics.isSlow ? 0 : 4);
  }

  outdate(): void {
    this.still.outdate();
  }

  shade(shading: Shading): void {
    setShading(this.anatomy.geometry, shading);
    this.outdate();
  }

  paint(layer: Layer, width: number, height: number, scale: number): HTMLCanvasElement {
    const { renderer } = this.graphics;
    const size = renderer.getSize(new three.Vector2());
    const [columns, rows] = [Math.round(width * scale), Math.round(height * scale)];
    if (size.x !== columns || size.y !== rows) renderer.setSize(columns, rows, false);
    if (this.lastColumns !== columns) this.outdate();
    this.lastColumns = columns;
    this.anatomy.geometry.setIndex(scale < 1 ? this.coarse : this.fine);
    const { top, bottom, zoom, far, near } = this.camera;
    const pixel = (top - bottom) / zoom / height / (far - near); // as a depth
    if (layer.cut) {
      this.hang(layer.cut, { scale, pixel });
      renderer.clear();
      renderer.render(this.scene, this.camera);
    } else {
      this.still.draw(renderer);
    }
    const lines = this.linesOf.get(layer) ?? layer.lengths.map((lengths) => new Line(lengths));
    this.linesOf.set(layer, lines);
    for (const line of lines) {
      // Parts that are visible through the surface are drawn over everything else.
      if (line.lengths.isSeenThrough) renderer.clearDepth();
      line.adjust(columns, rows, scale, pixel);
      renderer.render(line.mesh, this.camera);
    }
    this.drawBodies(layer.bodies ?? []);
    return renderer.domElement;
  }

  /** Draws bodies over the earlier content, using its depths. */
  private drawBodies(bodies: readonly Body[]): void {
    bodies.forEach(({ from, to, radius, color, hidden }, i) => {
      const capsule = this.capsules[i] ?? new Capsule();
      if (this.capsules[i] === undefined) this.instrument.add(...capsule.parts);
      this.capsules[i] = capsule;
      capsule.place(from, to, radius);
      capsule.paint(colorOf(color), hidden);
    });
    if (bodies.length > 0) this.graphics.renderer.render(this.instrument, this.camera);
  }

  dispose(): void {
    this.depths.dispose();
    for (const capsule of this.capsules) capsule.dispose();
    for (const { mesh } of [...this.linesOf.values()].flat()) discard(mesh);
    discard(this.anatomy);
  }

  private hang(cut: Cut, sizes: Readonly<Record<string, number>>): void {
    const { depths, ...frame } = cut;
    const data = depths as Float32Array<ArrayBuffer>;
    this.depths.image = { data, width: data.length, height: 1 };
    this.depths.needsUpdate = true;
    setUniforms(this.anatomy.material, { ...frame, ...sizes });
  }
}
