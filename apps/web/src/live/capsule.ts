// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";

/** A body of an instrument, which shows through what hides it, faintly. */
export class Capsule {
  readonly parts: three.Mesh[];
  private readonly solid: three.MeshStandardMaterial;
  private readonly ghost: three.MeshBasicMaterial;
  private length = -1; // of what the geometry was made for [mm]

  constructor(
    private readonly radius: number,
    color: string,
    opacity: number,
  ) {
    // All are drawn as what is transparent, so that what can be seen covers what shines through.
    this.solid = new three.MeshStandardMaterial({
      transparent: true,
      opacity,
      roughness: 0.35,
      depthWrite: opacity === 1,
    });
    this.ghost = new three.MeshBasicMaterial({
      transparent: true,
      opacity: 0.3,
      depthTest: false,
      depthWrite: false,
    });
    this.parts = [new three.Mesh(undefined, this.ghost), new three.Mesh(undefined, this.solid)];
    this.parts.forEach((part, i) => {
      part.renderOrder = i + 1;
    });
    this.paint(color);
  }

  show(isVisible: boolean): void {
    for (const part of this.parts) part.visible = isVisible;
  }

  paint(color: string): void {
    this.solid.color.set(color);
    this.ghost.color.set(color);
  }

  /** Its axis goes from here to there. */
  place(from: three.Vector3, to: three.Vector3): void {
    const way = to.clone().sub(from);
    const length = way.length();
    if (Math.abs(length - this.length) > 1e-3) {
      this.length = length;
      this.parts[0]?.geometry.dispose();
      const geometry = new three.CapsuleGeometry(this.radius, length, 10, 28);
      for (const part of this.parts) part.geometry = geometry;
    }
    for (const part of this.parts) {
      part.position.copy(from).addScaledVector(way, 0.5);
      part.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), way.clone().normalize());
    }
  }

  dispose(): void {
    this.parts[0]?.geometry.dispose();
    this.solid.dispose();
    this.ghost.dispose();
  }
}
