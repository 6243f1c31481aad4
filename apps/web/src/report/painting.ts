// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { Capsule } from "../page/capsule.ts";
import { colorOf } from "../page/color_of.ts";
import { type Graphics, surfaceGeometry } from "../page/graphics.ts";
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
  dispose(): void;
}

/** The appearance of bone, in linear light: the free side, the back, a section and its edge. */
export const materials = {
  bone: [0.8, 0.69, 0.52],
  hollow: [0.34, 0.2, 0.15],
  section: [0.88, 0.62, 0.42],
  edge: [0.2, 0.09, 0.05],
} as const;

/** Lines of a hatched section: distance and width. [px of the page] */
export const hatching = { period: 15, line: 1.7 } as const;

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
    this.anatomy = new three.Mesh(geometry, boneMaterial(isCut, anatomy.isClosed, this.depths));
    this.anatomy.frustumCulled = false;
    this.scene.add(this.anatomy);
    this.still = new StillPicture(this.scene, camera, graphics.isSlow ? 0 : 4);
  }

  outdate(): void {
    this.still.outdate();
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

/**
 * Returns bone, lit from the upper left of the view, with cuts hatched as in a technical drawing.
 */
function boneMaterial(
  isCut: boolean,
  isClosed: boolean,
  depths: three.Texture,
): three.ShaderMaterial {
  const color = (name: keyof typeof materials) =>
    `const vec3 ${name} = vec3(${materials[name].map((part) => part.toFixed(2)).join(", ")});`;
  return new three.ShaderMaterial({
    side: three.DoubleSide,
    defines: { ...(isCut && { CUT: "" }), ...(isCut && isClosed && { SOLID: "" }) },
    uniforms: {
      depths: { value: depths },
      sideways: { value: new three.Vector3() },
      toward: { value: new three.Vector3() },
      from: { value: 0 },
      to: { value: 1 },
      scale: { value: 1 },
      pixel: { value: 0 },
    },
    vertexShader: `
      varying vec3 place, eye, bent;
      void main() {
        place = position;
        eye = (modelViewMatrix * vec4(position, 1.0)).xyz;
        bent = normalMatrix * normal;
        gl_Position = projectionMatrix * vec4(eye, 1.0);
      }`,
    fragmentShader: `
      uniform sampler2D depths;
      uniform vec3 sideways, toward;
      uniform float from, to, scale, pixel;
      varying vec3 place, eye, bent;
      ${color("bone")} ${color("hollow")} ${color("section")} ${color("edge")}

      // Returns the distance of a place behind the curtain. [mm]
      float behind() {
        float last = float(textureSize(depths, 0).x - 1);
        float column = last * clamp((dot(place, sideways) - from) / (to - from), 0.0, 1.0);
        float left = texelFetch(depths, ivec2(int(column), 0), 0).r;
        float right = texelFetch(depths, ivec2(int(min(column + 1.0, last)), 0), 0).r;
        return mix(left, right, fract(column)) - dot(place, toward);
      }

      vec3 lit(vec3 material, vec3 normal) {
        const vec3 key = normalize(vec3(-0.45, 0.62, 0.64));
        const vec3 fill = normalize(vec3(0.75, -0.10, 0.65));
        const vec3 warm = vec3(1.00, 0.96, 0.89);
        const vec3 cool = vec3(0.86, 0.91, 1.00);
        // Wrapped a little beyond the terminator, as light in bone is.
        float keyLight = max(0.0, (dot(normal, key) + 0.15) / 1.15);
        float sky = 0.5 + 0.5 * normal.y;
        float gloss = pow(max(0.0, dot(normal, normalize(key + vec3(0.0, 0.0, 1.0)))), 40.0);
        return material * (warm * 0.86 * keyLight + cool * (0.15 * max(0.0, dot(normal, fill)) +
               0.09 + 0.13 * sky)) + warm * 0.05 * gloss;
      }

      void main() {
        vec3 flatNormal = normalize(cross(dFdx(eye), dFdy(eye)));
        vec3 normal = normalize(gl_FrontFacing ? bent : -bent);
        // Across a sharp edge there is no normal but that of the triangle.
        if (dot(normal, flatNormal) < 0.5) normal = flatNormal;
        vec3 color = lit(gl_FrontFacing ? bone : hollow, normal);
        #ifdef CUT
          float rest = behind();
          float reach = fwidth(rest);
          if (rest < 0.0) discard;
          if (rest < 1.2 * scale * reach) color = edge;
          gl_FragDepth = gl_FragCoord.z;
        #endif
        #ifdef SOLID
          if (!gl_FrontFacing) {
            float stripe = mod(gl_FragCoord.x - gl_FragCoord.y, ${hatching.period.toFixed(1)} * scale);
            color = section * (stripe < ${hatching.line.toFixed(1)} * scale ? 0.8 : 1.0);
            // It is before what folds behind it, which is not to show through at the fold.
            gl_FragDepth -= 6.0 * pixel;
          }
        #endif
        gl_FragColor = vec4(color, 1.0);
        #include <colorspace_fragment>
      }`,
  });
}
