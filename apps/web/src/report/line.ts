// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { colorOf } from "../page/color_of.ts";
import type { Lengths } from "./painting.ts";

/** The four corners of a drawn segment: its end and its side. */
const corners = [0, 0, 1, 1].map((end, i) => [end, i % 2 === 0 ? -1 : 1] as const);

/** Segments of paths as tubes with a constant width on the screen. */
export class Line {
  readonly mesh: Shaded;

  constructor(readonly lengths: Lengths) {
    const { ends } = lengths;
    const count = ends.length / 6;
    const own = new Float32Array(12 * count);
    const other = new Float32Array(12 * count);
    const corner = new Float32Array(8 * count);
    const index = new Uint32Array(6 * count);
    for (let i = 0; i < count; ++i) {
      corners.forEach(([end, side], k) => {
        const [from, to] = [6 * i + 3 * end, 6 * i + 3 * (1 - end)];
        own.set(ends.subarray(from, from + 3), 12 * i + 3 * k);
        other.set(ends.subarray(to, to + 3), 12 * i + 3 * k);
        corner.set([end, side], 8 * i + 2 * k);
      });
      index.set(
        [0, 1, 2, 2, 1, 3].map((k) => 4 * i + k),
        6 * i,
      );
    }
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(own, 3));
    geometry.setAttribute("other", new three.BufferAttribute(other, 3));
    geometry.setAttribute("corner", new three.BufferAttribute(corner, 2));
    geometry.setIndex(new three.BufferAttribute(index, 1));
    this.mesh = new three.Mesh(geometry, tubeMaterial());
    this.mesh.frustumCulled = false;
  }

  /** `width` and `height`: of the canvas; `pixel`: a pixel of the page, as a depth. */
  adjust(width: number, height: number, scale: number, pixel: number): void {
    const radius = this.lengths.width / 2 + 0.4;
    setUniforms(this.mesh.material, {
      color: new three.Color(colorOf(this.lengths.color)),
      middle: new three.Vector2(width / 2, height / 2),
      radius: radius * scale,
      depth: radius * pixel,
      opacity: this.lengths.opacity ?? 1,
    });
  }
}

/** A mesh with a shader. */
export type Shaded = three.Mesh<three.BufferGeometry, three.ShaderMaterial>;

/** Sets the uniforms of a shader by name. */
export function setUniforms({ uniforms }: three.ShaderMaterial, values: object): void {
  for (const [name, value] of Object.entries(values)) {
    (uniforms[name] as three.IUniform).value = value;
  }
}

export function discard({ geometry, material }: Shaded): void {
  geometry.dispose();
  material.dispose();
}

/** Returns a tube with round ends, lit and rimmed so that it stands out from bone. */
const tubeMaterial = (): three.ShaderMaterial =>
  new three.ShaderMaterial({
    side: three.DoubleSide,
    uniforms: {
      color: { value: new three.Color() },
      middle: { value: new three.Vector2() },
      radius: { value: 1 },
      depth: { value: 0 },
      opacity: { value: 1 },
    },
    transparent: true,
    vertexShader: `
      attribute vec3 other;
      attribute vec2 corner;
      uniform vec2 middle;
      uniform float radius;
      varying vec2 across; // the direction across the tube
      varying vec3 place;  // off the axis, along it, and the length of it [radius]
      void main() {
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        vec2 end = (projectionMatrix * modelViewMatrix * vec4(other, 1.0)).xy;
        vec2 way = (corner.x < 0.5 ? 1.0 : -1.0) * (end - gl_Position.xy) * middle;
        float size = length(way);
        vec2 along = size > 1e-6 ? way / size : vec2(1.0, 0.0);
        across = vec2(-along.y, along.x);
        float beyond = 2.0 * corner.x - 1.0;
        gl_Position.xy += radius * (across * corner.y + along * beyond) / middle;
        place = vec3(corner.y, corner.x * size / radius + beyond, size / radius);
      }`,
    fragmentShader: `
      uniform vec3 color;
      uniform float depth, opacity;
      varying vec2 across;
      varying vec3 place;
      void main() {
        float beyond = max(max(-place.y, place.y - place.z), 0.0);
        float rest = 1.0 - place.x * place.x - beyond * beyond;
        if (rest < 0.0) discard;
        vec3 normal = vec3(across * place.x, sqrt(1.0 - place.x * place.x));
        float light = 0.72 + 0.38 * max(0.0, dot(normal, normalize(vec3(-0.40, 0.55, 0.73))));
        if (rest < 0.3) light *= 0.4;
        gl_FragColor = vec4(light * color, opacity);
        // It lies before the surface that it touches.
        gl_FragDepth = gl_FragCoord.z - depth * (1.0 + sqrt(rest));
        #include <colorspace_fragment>
      }`,
  });
