// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";

/** The axis is along y. Vertices above the middle belong to one end, all others to the other. */
export const unitCapsule = new three.CapsuleGeometry(1, 1, 16, 48);

/**
 * A capsule: a body of an instrument, or a ball if the axis has no length. It shines faintly
 * through a surface that hides it.
 */
export class Capsule {
  /** The hidden part, then the visible part. */
  readonly parts: readonly three.Mesh<three.BufferGeometry, three.ShaderMaterial>[];
  private readonly uniforms = {
    from: { value: new three.Vector3() },
    to: { value: new three.Vector3() },
    radius: { value: 1 },
    axes: { value: new three.Matrix3() },
    color: { value: new three.Color() },
  };

  /** `opacity`: of the visible part, from 0 to 1. */
  constructor(opacity = 1) {
    const part = (isHidden: boolean) => {
      const own = { ...this.uniforms, opacity: { value: isHidden ? 0.3 : opacity } };
      const made = new three.Mesh(unitCapsule, capsuleMaterial(own));
      made.material.depthFunc = isHidden ? three.GreaterDepth : three.LessEqualDepth;
      made.material.depthWrite = !isHidden && opacity === 1;
      made.renderOrder = isHidden ? 1 : 2;
      made.frustumCulled = false;
      return made;
    };
    this.parts = [part(true), part(false)];
  }

  /** Sets the ends of the axis, and the radius. */
  place(from: three.Vector3, to: three.Vector3, radius: number): void {
    const { uniforms } = this;
    uniforms.from.value.copy(from);
    uniforms.to.value.copy(to);
    uniforms.radius.value = radius;
    const along = to.clone().sub(from).normalize();
    const turn = new three.Quaternion().setFromUnitVectors(new three.Vector3(0, 1, 0), along);
    const axes = new three.Matrix4().makeRotationFromQuaternion(turn);
    uniforms.axes.value.setFromMatrix4(axes);
    // Transparent bodies are drawn from back to front.
    for (const { position } of this.parts) position.lerpVectors(from, to, 0.5);
  }

  /** `hidden`: the opacity where the surface hides it, from 0 to 1. */
  paint(color: three.ColorRepresentation, hidden = 0.3): void {
    this.uniforms.color.value.set(color);
    const opacity = this.parts[0]?.material.uniforms.opacity;
    if (opacity) opacity.value = hidden;
  }

  show(isVisible: boolean): void {
    for (const part of this.parts) part.visible = isVisible;
  }

  dispose(): void {
    for (const { material } of this.parts) material.dispose();
  }
}

/** Places the vertices of `unitCapsule`, and passes on their normals in the view. */
export const capsuleVertices = `
  uniform vec3 from, to;
  uniform float radius;
  uniform mat3 axes;
  varying vec3 bent;
  void main() {
    vec3 place = (position.y > 0.0 ? to : from) + radius * (axes * normal);
    bent = normalMatrix * (axes * normal);
    gl_Position = projectionMatrix * viewMatrix * vec4(place, 1.0);
  }`;

/** Lit like paths, from the upper left of the view. */
const capsuleMaterial = (uniforms: Record<string, three.IUniform>) =>
  new three.ShaderMaterial({
    transparent: true,
    uniforms,
    vertexShader: capsuleVertices,
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
