// SPDX-License-Identifier: BSD-3-Clause
/** Drawings that belong to hand, tool and planes, except their bodies. */
import * as three from "three";

export const colors = {
  hand: "#e5484d",
  plane: "#e8a90c",
  guide: "#9a5cf0",
  bone: "#e9dfce",
  steel: "#8d9db5",
} as const;

/** The number of points of a trail, for some seconds. */
const trailLength = 240;

/** The last positions of a point. */
export class Trail {
  readonly line = new three.Line(
    new three.BufferGeometry(),
    new three.LineBasicMaterial({ transparent: true, opacity: 0.8, depthTest: false }),
  );
  private readonly points: three.Vector3[] = [];

  constructor() {
    this.line.frustumCulled = false;
  }

  paint(color: string): void {
    this.line.material.color.set(color);
  }

  add(point: three.Vector3): void {
    this.points.push(point);
    if (this.points.length > trailLength) this.points.shift();
    this.show();
  }

  clear(): void {
    this.points.length = 0;
    this.show();
  }

  private show(): void {
    this.line.geometry.dispose();
    this.line.geometry = new three.BufferGeometry().setFromPoints(this.points);
  }
}

/** The spring between hand and tool. */
export class Spring {
  readonly line = new three.Mesh(
    new three.CylinderGeometry(1, 1, 1, 12),
    new three.MeshBasicMaterial({
      color: colors.hand,
      transparent: true,
      opacity: 0.75,
      depthTest: false,
    }),
  );

  /** Draws it between two points; hides it if it is shorter than `least`. */
  stretch(from: three.Vector3, to: three.Vector3, radius: number, least: number): void {
    const way = to.clone().sub(from);
    const length = way.length();
    this.line.visible = length > least;
    if (!this.line.visible) return;
    this.line.position.copy(from).addScaledVector(way, 0.5);
    this.line.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), way.divideScalar(length));
    this.line.scale.set(radius, length, radius);
  }
}

/** A plane: a disc with a rim, of radius 1. */
export function sheet(color: string): three.Group {
  const shared = { color, side: three.DoubleSide, transparent: true };
  const disc = new three.Mesh(
    new three.CircleGeometry(1, 64),
    new three.MeshBasicMaterial({ ...shared, opacity: 0.22, depthWrite: false }),
  );
  const rim = new three.Mesh(
    new three.RingGeometry(0.97, 1, 64),
    new three.MeshBasicMaterial({ ...shared, opacity: 0.9, depthWrite: false }),
  );
  rim.userData.isRim = true;
  return new three.Group().add(disc, rim);
}
