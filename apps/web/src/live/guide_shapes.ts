// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import type { Guide, Vec3 } from "../engine/keepout.ts";
import { colors, sheet } from "./markers.ts";

const opacity = { free: 0.13, limiting: 0.3 } as const;

/** Draws guidance constraints, translucent: planes as discs, tubes and balls as surfaces. */
export class GuideShapes {
  readonly group = new three.Group();
  private shapes: three.Object3D[] = [];

  /**
   * Draws these guides. `inside`: maps a position to the scene. `size`: the visible size of planes
   * and tubes. [mm]
   */
  show(guides: readonly Guide[], inside: (place: Vec3) => three.Vector3, size: number): void {
    this.group.traverse((part) => {
      if (part instanceof three.Mesh) {
        part.geometry.dispose();
        part.material.dispose();
      }
    });
    this.group.clear();
    this.shapes = guides.map((guide) => shapeOf(guide, size));
    this.shapes.forEach((shape, i) => {
      shape.position.copy(inside((guides[i] as Guide).origin));
      shape.visible = !guides[i]?.isAngular;
    });
    if (this.shapes.length > 0) this.group.add(...this.shapes);
    this.mark(0);
  }

  /** Highlights the guides that limit the motion: bit g for guide g. */
  mark(limiting: number): void {
    this.shapes.forEach((shape, g) => {
      const isLimiting = Math.floor(limiting / 2 ** g) % 2 === 1;
      shape.traverse((part) => {
        if (part instanceof three.Mesh && !part.userData.isRim) {
          part.material.opacity = isLimiting ? opacity.limiting : opacity.free;
        }
      });
    });
  }
}

/** Returns the boundary of a region about the origin. */
function shapeOf({ kind, direction, radius }: Guide, size: number): three.Object3D {
  const along = new three.Vector3(...direction);
  if (kind === "half_space" || kind === "slab") {
    const sides = kind === "slab" ? [-radius, radius] : [0];
    const discs = sides.map((height) => {
      const disc = sheet(colors.guide);
      disc.position.copy(along).multiplyScalar(height);
      disc.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), along);
      disc.scale.setScalar(size);
      return disc;
    });
    return new three.Group().add(...discs);
  }
  const surface =
    kind === "tube"
      ? new three.CylinderGeometry(radius, radius, 2 * size, 48, 1, true)
      : new three.SphereGeometry(radius, 48, 24);
  const shape = new three.Mesh(
    surface,
    new three.MeshBasicMaterial({
      color: colors.guide,
      side: three.DoubleSide,
      transparent: true,
      depthWrite: false,
    }),
  );
  if (kind === "tube") shape.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), along);
  return shape;
}
