// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { FullScreenQuad } from "three/addons/postprocessing/Pass.js";

/** Changes the picture of the still parts each time it is shown. */
export interface Overlay {
  readonly uniforms: Record<string, three.IUniform>;
  /** GLSL with a function `vec3 over(vec3 color, vec3 place)`, in linear light and the scene. */
  readonly code: string;
}

/**
 * A picture of the still parts, with depths, which is drawn again only when the view changes. While
 * the tool is dragged, an anatomy of half a million triangles then costs no more than a rectangle.
 * This helps phones, and computers without a graphics processor.
 */
export class StillPicture {
  private readonly target: three.WebGLRenderTarget;
  private readonly sheet: FullScreenQuad;
  private readonly material: three.ShaderMaterial;
  private readonly toScene = new three.Matrix4();
  private isOutdated = true;

  /** `samples`: per pixel, for smooth edges. */
  constructor(
    private readonly scene: three.Scene,
    private readonly camera: three.Camera,
    samples: number,
    overlay: Overlay | null = null,
  ) {
    this.target = new three.WebGLRenderTarget(1, 1, {
      samples,
      type: three.HalfFloatType,
      depthTexture: new three.DepthTexture(1, 1),
    });
    this.material = new three.ShaderMaterial({
      defines: overlay === null ? {} : { OVERLAY: "" },
      uniforms: {
        picture: { value: this.target.texture },
        depths: { value: this.target.depthTexture },
        toScene: { value: this.toScene },
        ...overlay?.uniforms,
      },
      vertexShader: `
        varying vec2 place;
        void main() {
          place = uv;
          gl_Position = vec4(position.xy, 0.0, 1.0);
        }`,
      fragmentShader: `
        uniform sampler2D picture;
        uniform highp sampler2D depths;
        uniform mat4 toScene;
        varying vec2 place;
        #ifdef OVERLAY
          ${overlay?.code ?? ""}
        #endif
        void main() {
          gl_FragColor = texture2D(picture, place);
          float depth = texture2D(depths, place).r;
          gl_FragDepth = depth;
          #ifdef OVERLAY
            vec4 at = toScene * (2.0 * vec4(place, depth, 1.0) - 1.0);
            gl_FragColor.rgb = over(gl_FragColor.rgb, at.xyz / at.w) * step(1e-3, gl_FragColor.a);
          #endif
          #include <colorspace_fragment>
        }`,
      depthFunc: three.AlwaysDepth,
      blending: three.NoBlending,
    });
    this.sheet = new FullScreenQuad(this.material);
  }

  /** Marks the picture as outdated. */
  outdate(): void {
    this.isOutdated = true;
  }

  /** Makes the picture finer or lighter. `samples`: per pixel. `overlay`: true to apply it. */
  adjust(samples: number, overlay: boolean): void {
    if (samples !== this.target.samples) {
      this.target.dispose();
      this.target.samples = samples;
      this.outdate();
    }
    if (overlay === "OVERLAY" in this.material.defines) return;
    if (overlay) this.material.defines.OVERLAY = "";
    else delete this.material.defines.OVERLAY;
    this.material.needsUpdate = true;
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
      this.toScene
        .multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse)
        .invert();
    }
    renderer.clear();
    this.sheet.render(renderer);
  }
}
