// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import type { Shading } from "./shading.ts";

/** A WebGL renderer, which draws over the earlier content. */
export interface Graphics {
  readonly renderer: three.WebGLRenderer;
  /** True without a graphics processor, where every pixel takes time. */
  readonly isSlow: boolean;
}

/** Throws without WebGL. */
export function makeGraphics(antialias: boolean): Graphics {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("webgl2", { alpha: true, antialias });
  if (!context) throw new Error("there is no WebGL");
  const renderer = new three.WebGLRenderer({ canvas, context, alpha: true });
  renderer.autoClear = false;
  renderer.setClearColor(0, 0);
  const names = context.getExtension("WEBGL_debug_renderer_info");
  const name = context.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER);
  return { renderer, isSlow: /swiftshader|llvmpipe|software/i.test(String(name)) };
}

/** Returns a surface with plain shading: (n, 3) coordinates and (m, 3) corners. */
export function surfaceGeometry(positions: Float32Array, corners: Uint32Array) {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.BufferAttribute(positions, 3));
  geometry.setIndex(new three.BufferAttribute(corners, 1));
  geometry.computeVertexNormals();
  setAmbience(geometry, new Uint8Array(positions.length / 3).fill(255));
  return geometry;
}

/** Gives a surface its shading. */
export function setShading(geometry: three.BufferGeometry, { normals, ambience }: Shading): void {
  geometry.setAttribute("normal", new three.BufferAttribute(normals, 3));
  setAmbience(geometry, ambience);
}

const setAmbience = (geometry: three.BufferGeometry, ambience: Uint8Array): void => {
  geometry.setAttribute("ambience", new three.BufferAttribute(ambience, 1, true));
};
