// SPDX-License-Identifier: BSD-3-Clause
/** What is drawn of hand, tool and planes. */
import * as three from "three";

export const colors = {
  hand: "#e5484d",
  tool: "#2f7df6",
  plane: "#0fb5a3",
  bone: "#e9dfce",
} as const;

/** Points of a trail: some seconds. */
const trailLength = 240;

/** A body that shows through what hides it, faintly. */
export class Body {
  protected readonly solid: three.Mesh<three.BufferGeometry, three.MeshStandardMaterial>;
  protected readonly ghost: three.Mesh<three.BufferGeometry, three.MeshBasicMaterial>;

  constructor(color: string, opacity: number, geometry?: three.BufferGeometry) {
    // Both are drawn as what is transparent, in an order of their own.
    const faint = { color, transparent: true };
    const depthWrite = opacity === 1;
    this.solid = new three.Mesh(
      geometry,
      new three.MeshStandardMaterial({ ...faint, opacity, roughness: 0.35, depthWrite }),
    );
    const through = { opacity: 0.3, depthTest: false, depthWrite: false };
    this.ghost = new three.Mesh(geometry, new three.MeshBasicMaterial({ ...faint, ...through }));
  }

  get parts(): readonly three.Mesh[] {
    return [this.solid, this.ghost];
  }
}

/** The ball of a tip, or of its hand. */
export class Ball extends Body {
  constructor(color: string, opacity: number) {
    super(color, opacity, new three.SphereGeometry(1, 40, 24));
  }

  place(at: three.Vector3, radius: number): void {
    for (const part of this.parts) {
      part.position.copy(at);
      part.scale.setScalar(radius);
    }
  }
}

/** A capsule of an instrument. */
export class Capsule extends Body {
  private length = -1; // of what the geometry was made for [mm]

  constructor(
    private readonly radius: number,
    color: string,
    opacity: number,
  ) {
    super(color, opacity);
    // The visible part is drawn over the part behind the surface.
    this.ghost.renderOrder = 1;
    this.solid.renderOrder = 2;
  }

  show(isVisible: boolean): void {
    for (const part of this.parts) part.visible = isVisible;
  }

  paint(color: string): void {
    this.solid.material.color.set(color);
    this.ghost.material.color.set(color);
  }

  /** Its axis goes from here to there. */
  place(from: three.Vector3, to: three.Vector3): void {
    const way = to.clone().sub(from);
    const length = way.length();
    if (Math.abs(length - this.length) > 1e-3) {
      this.length = length;
      this.solid.geometry.dispose();
      this.solid.geometry = new three.CapsuleGeometry(this.radius, length, 10, 28);
      this.ghost.geometry = this.solid.geometry;
    }
    for (const part of this.parts) {
      part.position.copy(from).addScaledVector(way, 0.5);
      part.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), way.clone().normalize());
    }
  }

  dispose(): void {
    this.solid.geometry.dispose();
    this.solid.material.dispose();
    this.ghost.material.dispose();
  }
}

/** Where a point was lately. */
export class Trail {
  readonly line: three.Line;
  private readonly points: three.Vector3[] = [];

  constructor(color: string) {
    this.line = new three.Line(
      new three.BufferGeometry(),
      new three.LineBasicMaterial({ color, transparent: true, opacity: 0.8, depthTest: false }),
    );
    this.line.frustumCulled = false;
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

  /** From here to there; not seen where that is shorter than `least`. */
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

/** An active plane: a disc with a rim, of radius 1. */
export function sheet(): three.Group {
  const shared = { color: colors.plane, side: three.DoubleSide, transparent: true };
  const disc = new three.Mesh(
    new three.CircleGeometry(1, 64),
    new three.MeshBasicMaterial({ ...shared, opacity: 0.22, depthWrite: false }),
  );
  const rim = new three.Mesh(
    new three.RingGeometry(0.97, 1, 64),
    new three.MeshBasicMaterial({ ...shared, opacity: 0.9, depthWrite: false }),
  );
  return new three.Group().add(disc, rim);
}
