// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { FullScreenQuad } from "three/addons/postprocessing/Pass.js";

/**
 * A picture of the still parts, with depths, which is drawn again only when the view changes. While
 * the tool is dragged, an anatomy of half a million triangles then costs no more than a rectangle.
 * This helps phones, and computers without a graphics processor.
 */
export class StillPicture {
  private readonly target: three.WebGLRenderTarget;
  private readonly sheet: FullScreenQuad;
  private isOutdated = true;

  /** `samples`: per pixel, for smooth edges. */
  constructor(
    private readonly scene: three.Scene,
    private readonly camera: three.Camera,
    samples: number,
  ) {
    this.target = new three.WebGLRenderTarget(1, 1, {
      samples,
      type: three.HalfFloatType,
      depthTexture: new three.DepthTexture(1, 1),
    });
    const material = new three.ShaderMaterial({
      uniforms: {
        picture: { value: this.target.texture },
        depths: { value: this.target.depthTexture },
      },
      vertexShader: `
        varying vec2 place;
        void main() {
          place = uv;
          gl_Position = vec4(position.xy, 0.0, 1.0);
        }`,
      fragmentShader: `
        uniform sampler2D picture;
        uniform sampler2D depths;
        varying vec2 place;
        void main() {
          gl_FragColor = texture2D(picture, place);
          gl_FragDepth = texture2D(depths, place).r;
          #include <colorspace_fragment>
        }`,
      depthFunc: three.AlwaysDepth,
      blending: three.NoBlending,
    });
    this.sheet = new FullScreenQuad(material);
  }

  /** Marks the picture as outdated. */
  outdate(): void {
    this.isOutdated = true;
  }

  /** Fills the renderer's viewport with the picture and its depths. */
  draw(renderer: three.WebGLRenderer): void {
    if (this.isOutdated) {
      const { z: width, w: height } = renderer.getCurrentViewport(new three.Vector4());
      this.target.setSize(width, height);
      renderer.setRenderTarget(this.target);
      renderer.clear();
      renderer.render(this.scene, this.camera);
      renderer.setRenderTarget(null);
      this.isOutdated = false;
    }
    renderer.clear();
    this.sheet.render(renderer);
  }
}
