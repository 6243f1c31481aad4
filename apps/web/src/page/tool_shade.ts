// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import type { Overlay } from "./still_picture.ts";

/** A body of a tool in the scene: a capsule, or a ball if its ends are the same. */
export interface ToolBody {
  readonly from: three.Vector3;
  readonly to: three.Vector3;
  readonly radius: number;
}

/** The largest number of bodies of a tool. */
const most = 4;

/**
 * The color of the surface by its distance from the tool, near to far. They differ in lightness and
 * are blue, which no tissue is, so readers with color blindness see them apart.
 */
export const clearanceColors = ["#1b0b5c", "#2446b8", "#2f8fd6", "#7cc7e8", "#cdeaf2"] as const;

/**
 * The marks of the tool on the picture of the still anatomy: its soft shadow, and the color of the
 * clearance around it. Only some numbers change with the tool; nothing of the mesh is sent again.
 */
export class ToolShade implements Overlay {
  readonly uniforms = {
    starts: { value: vectors() },
    ends: { value: vectors() },
    bodies: { value: 0 },
    /** The distance that has a color at most. [mm] */
    range: { value: 5 },
    /** The direction to the light. */
    sun: { value: new three.Vector3() },
    bands: { value: clearanceColors.map((color) => new three.Color(color)) },
    inner: { value: new three.Color() },
  };

  readonly code = `
    uniform vec4 starts[${most}], ends[${most}];
    uniform int bodies;
    uniform float range;
    uniform vec3 sun, bands[${clearanceColors.length}], inner;

    vec3 over(vec3 color, vec3 place) {
      float nearest = 1e9, light = 1.0;
      for (int i = 0; i < bodies; ++i) {
        vec3 axis = ends[i].xyz - starts[i].xyz;
        float share = dot(place - starts[i].xyz, axis) / max(dot(axis, axis), 1e-12);
        vec3 way = starts[i].xyz + clamp(share, 0.0, 1.0) * axis - place;
        float radius = starts[i].w;
        float away = length(way);
        nearest = min(nearest, away - radius);
        // The shadow is the softer, the farther the tool is.
        float along = dot(way, sun);
        float beside = length(way - along * sun);
        float soft = 0.35 * radius + 0.3 * max(along, 0.0);
        float shadow = step(0.0, along) * (1.0 - smoothstep(radius - soft, radius + soft, beside));
        light *= 1.0 - 0.5 * shadow / (1.0 + 0.02 * away * away / (radius * radius));
        float close = radius / max(away, radius);
        light *= 1.0 - 0.35 * close * close * close;
      }
      color *= light;
      if (nearest >= range) return color;
      if (nearest < 0.0) return mix(color, inner, 0.75);
      float at = ${clearanceColors.length}.0 * nearest / range;
      int band = min(int(at), ${clearanceColors.length - 1});
      float width = fwidth(at);
      float line = smoothstep(0.0, 1.5 * width, fract(at)) * 0.25 + 0.75;
      float fade = 0.85 * (1.0 - 0.5 * nearest / range);
      vec3 tint = mix(color, bands[band] * (0.35 + 0.9 * dot(color, vec3(0.3, 0.6, 0.1))), fade);
      return tint * mix(1.0, line, clamp(0.5 / width, 0.0, 1.0));
    }`;

  /** `alarm`: the color where the surface is inside of the tool. */
  place(tool: readonly ToolBody[], sun: three.Vector3, range: number, alarm: string): void {
    const { starts, ends, bodies } = this.uniforms;
    bodies.value = Math.min(tool.length, most);
    for (const [i, { from, to, radius }] of tool.slice(0, most).entries()) {
      starts.value[i]?.set(from.x, from.y, from.z, radius);
      ends.value[i]?.set(to.x, to.y, to.z, radius);
    }
    this.uniforms.sun.value.copy(sun);
    this.uniforms.range.value = range;
    this.uniforms.inner.value.set(alarm);
  }
}

const vectors = () => Array.from({ length: most }, () => new three.Vector4());
