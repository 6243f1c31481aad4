// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { colorOf } from "../page/color_of.ts";
import { type Shaded, setUniforms } from "./line.ts";

/** A body of an instrument: all within a radius of what is between two places. */
export interface Capsule {
  readonly from: three.Vector3;
  readonly to: three.Vector3;
  /** [mm] */
  readonly radius: number;
  /** The variable of the page's style that has the colour. */
  readonly color: string;
  /** How strong it is drawn where the surface hides it, from 0 to 1. */
  readonly hidden: number;
}

/** Draws capsules over what was drawn before, and with its depths. */
export class CapsuleBrush {
  readonly mesh: Shaded = new three.Mesh(
    new three.CapsuleGeometry(1, 1, 12, 32),
    capsuleMaterial(),
  );

  constructor() {
    this.mesh.frustumCulled = false;
  }

  draw(renderer: three.WebGLRenderer, camera: three.Camera, capsules: readonly Capsule[]): void {
    // What is hidden of all of them, and then what is seen.
    for (const isHidden of [true, false]) {
      this.mesh.material.depthFunc = isHidden ? three.GreaterDepth : three.LessEqualDepth;
      this.mesh.material.depthWrite = !isHidden;
      for (const { from, to, radius, color: variable, hidden } of capsules) {
        const along = to.clone().sub(from).normalize();
        const turn = new three.Quaternion().setFromUnitVectors(new three.Vector3(0, 1, 0), along);
        const axes = new three.Matrix3().setFromMatrix4(
          new three.Matrix4().makeRotationFromQuaternion(turn),
        );
        const color = new three.Color(colorOf(variable));
        const opacity = isHidden ? hidden : 1;
        setUniforms(this.mesh.material, { from, to, radius, axes, color, opacity });
        renderer.render(this.mesh, camera);
      }
    }
  }
}

/** Lit as paths are. What is above the geometry's middle is about one end, all else about the other. */
const capsuleMaterial = (): three.ShaderMaterial =>
  new three.ShaderMaterial({
    transparent: true,
    uniforms: {
      from: { value: new three.Vector3() },
      to: { value: new three.Vector3() },
      radius: { value: 1 },
      axes: { value: new three.Matrix3() },
      color: { value: new three.Color() },
      opacity: { value: 1 },
    },
    vertexShader: `
      uniform vec3 from, to;
      uniform float radius;
      uniform mat3 axes;
      varying vec3 bent;
      void main() {
        vec3 place = (position.y > 0.0 ? to : from) + radius * (axes * normal);
        bent = normalMatrix * (axes * normal);
        gl_Position = projectionMatrix * modelViewMatrix * vec4(place, 1.0);
      }`,
    fragmentShader: `
      uniform vec3 color;
      uniform float opacity;
      varying vec3 bent;
      void main() {
        vec3 normal = normalize(bent);
        float light = 0.5 + 0.6 * max(0.0, dot(normal, normalize(vec3(-0.40, 0.55, 0.73))));
        if (normal.z < 0.25) light *= 0.6;
        gl_FragColor = vec4(light * color, opacity);
        #include <colorspace_fragment>
      }`,
  });
