// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import type { Tissue } from "./tissue.ts";

/** Lines of a hatched section: distance and width. [px of the page] */
export const hatching = { period: 15, line: 1.7 } as const;

/** For a picture with cuts: the curtain, whose part before it is removed. */
export interface CutOptions {
  readonly isClosed: boolean;
  readonly depths: three.Texture;
}

/**
 * Returns the material of an anatomy, lit from the upper left of the view. Vertices have an
 * attribute `ambience`, see shading.ts. Cuts are hatched as in a technical drawing.
 */
export function anatomyMaterial(tissue: Tissue, cut: CutOptions | null): three.ShaderMaterial {
  const material = new three.ShaderMaterial({
    side: three.DoubleSide,
    defines: { ...(cut && { CUT: "" }), ...(cut?.isClosed && { SOLID: "" }) },
    uniforms: {
      ...Object.fromEntries(parts.map((name) => [name, { value: new three.Vector3() }])),
      gloss: { value: 0 },
      creases: { value: 0 },
      depths: { value: cut?.depths ?? null },
      sideways: { value: new three.Vector3() },
      toward: { value: new three.Vector3() },
      from: { value: 0 },
      to: { value: 1 },
      scale: { value: 1 },
      pixel: { value: 0 },
    },
    vertexShader: `
      attribute float ambience;
      varying vec3 place, eye, bent;
      varying float open;
      void main() {
        place = position;
        eye = (modelViewMatrix * vec4(position, 1.0)).xyz;
        bent = normalMatrix * normal;
        open = ambience;
        gl_Position = projectionMatrix * vec4(eye, 1.0);
      }`,
    fragmentShader: `
      uniform sampler2D depths;
      uniform vec3 sideways, toward, ${parts.join(", ")};
      uniform float from, to, scale, pixel, gloss, creases;
      varying vec3 place, eye, bent;
      varying float open;

      // Returns the distance of a place behind the curtain. [mm]
      float behind() {
        float last = float(textureSize(depths, 0).x - 1);
        float column = last * clamp((dot(place, sideways) - from) / (to - from), 0.0, 1.0);
        float left = texelFetch(depths, ivec2(int(column), 0), 0).r;
        float right = texelFetch(depths, ivec2(int(min(column + 1.0, last)), 0), 0).r;
        return mix(left, right, fract(column)) - dot(place, toward);
      }

      vec3 lit(vec3 material, vec3 normal, vec3 seen) {
        const vec3 key = normalize(vec3(-0.45, 0.62, 0.64));
        const vec3 fill = normalize(vec3(0.75, -0.10, 0.65));
        const vec3 warm = vec3(1.00, 0.96, 0.89);
        const vec3 cool = vec3(0.86, 0.91, 1.00);
        // Wrapped a little beyond the terminator, as light in bone is.
        float keyLight = max(0.0, (dot(normal, key) + 0.15) / 1.15);
        float sky = 0.5 + 0.5 * normal.y;
        float shine = pow(max(0.0, dot(normal, normalize(key + seen))), 34.0);
        float rim = pow(1.0 - max(0.0, dot(normal, seen)), 3.0);
        vec3 around = cool * (0.15 * max(0.0, dot(normal, fill)) + 0.10 + 0.15 * sky);
        return material * (warm * 0.86 * keyLight * mix(0.45, 1.0, open) + around * open) +
               open * gloss * (warm * shine * keyLight + cool * 0.22 * rim * sky);
      }

      void main() {
        vec3 seen = isOrthographic ? vec3(0.0, 0.0, 1.0) : normalize(-eye);
        vec3 normal = (gl_FrontFacing ? bent : -bent) / max(length(bent), 1e-6);
        // At a sharp edge there is no normal but that of the triangle.
        vec3 flatNormal = normalize(cross(dFdx(eye), dFdy(eye)));
        float smoothness = smoothstep(0.2, 0.95, length(bent)) * smoothstep(0.8, 0.93, dot(normal, flatNormal));
        normal = mix(normal, flatNormal, creases * (1.0 - smoothness));
        // A smoothed normal may point away from the eye.
        normal = normalize(normal + seen * max(0.0, 0.04 - dot(normal, seen)));
        vec3 color = lit(gl_FrontFacing ? mix(valley, base, smoothstep(0.25, 0.9, open)) : hollow, normal, seen);
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
  paintTissue(material, tissue);
  return material;
}

const parts = ["base", "valley", "hollow", "section", "edge"] as const;

/** Gives a material of anatomyMaterial() the appearance of another tissue. */
export function paintTissue({ uniforms }: three.ShaderMaterial, tissue: Tissue): void {
  for (const name of parts) uniforms[name]?.value.set(...tissue[name]);
  if (uniforms.gloss) uniforms.gloss.value = tissue.gloss;
  if (uniforms.creases) uniforms.creases.value = Number(tissue.creases);
}
