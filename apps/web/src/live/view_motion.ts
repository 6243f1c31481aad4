// SPDX-License-Identifier: BSD-3-Clause
import { MathUtils, type PerspectiveCamera, Quaternion, Vector3 } from "three";
import type { OrbitControls } from "three/addons/controls/OrbitControls.js";

/** The smallest angle between the view and the vertical. [rad] */
const least = 0.05;
const vertical = new Vector3(0, 0, 1);

/**
 * Turns and zooms a view about a point, which stays where it is on the screen; by default about the middle of the
 * view.
 */
export class ViewMotion {
  constructor(
    private readonly camera: PerspectiveCamera,
    private readonly controls: OrbitControls,
  ) {}

  /** Moves the camera around the vertical through the point, and up. [rad] */
  turn(around: number, up: number, about = this.controls.target.clone()): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const now = offset.angleTo(vertical);
    const next = MathUtils.clamp(now - up, least, Math.PI - least);
    const right = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const turn = new Quaternion()
      .setFromAxisAngle(vertical, around)
      .multiply(new Quaternion().setFromAxisAngle(right, next - now));
    this.change(about, (point) => point.applyQuaternion(turn));
  }

  /** Brings the camera nearer by a factor. */
  zoom(factor: number, about = this.controls.target.clone()): void {
    const { minDistance, maxDistance } = this.controls;
    const now = this.camera.position.distanceTo(this.controls.target);
    const next = MathUtils.clamp(now / factor, minDistance, maxDistance);
    this.change(about, (point) => point.multiplyScalar(next / now));
  }

  /** Moves camera and middle by a map about a point. */
  private change(about: Vector3, map: (point: Vector3) => void): void {
    for (const point of [this.camera.position, this.controls.target]) {
      point.sub(about);
      map(point);
      point.add(about);
    }
    this.controls.update();
    this.camera.updateMatrixWorld();
  }
}
