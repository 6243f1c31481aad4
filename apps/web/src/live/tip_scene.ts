// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import type { Vec3 } from "../engine/keepout.ts";
import type { ToolFacts } from "../engine/tool.ts";
import { Ball, colors, sheet } from "./markers.ts";
import type { State } from "./protocol.ts";
import { Scene } from "./scene.ts";

/** How many active planes are drawn at most. */
const mostPlanes = 8;
/** Where the tool may begin: how high in the view, and how near. [sizes of the anatomy] */
const placesToBegin = [0.3, 0.2, 0.1, 0].flatMap((near) =>
  [0.16, 0.08, 0.24, 0, -0.08].map((height) => [height, near] as const),
);
/** A ball that is smaller than this share of what is seen is drawn as large. */
const smallestBall = 0.006;

/** The anatomy, and in it the hand, the ball of a tip and the planes that limit its motion. */
export class TipScene extends Scene {
  private readonly hand = new Ball(colors.hand, 0.35);
  private readonly tool = new Ball(colors.tool, 1);
  private readonly planes: three.Group[] = [];
  private readonly edges = new three.LineSegments(
    new three.BufferGeometry(),
    new three.LineBasicMaterial({ color: colors.plane, depthTest: false, transparent: true }),
  );

  constructor(container: HTMLElement, room: () => number, onDraw: () => void) {
    super(container, room, onDraw);
    for (let i = 0; i < mostPlanes; ++i) this.planes.push(sheet());
    this.moving.add(...this.hand.parts, ...this.tool.parts, this.edges, ...this.planes);
  }

  equip({ bodies }: ToolFacts): void {
    this.toolRadius = bodies[0]?.radius ?? 1;
    this.redraw();
  }

  /**
   * A place for the tool to begin: beside the half of the anatomy that is seen, where a motion across
   * the view leads into it and stays in sight. `kept`: what the tool keeps from the surface. [mm]
   */
  placeBeside(kept: number): Vec3 {
    const distance = kept + this.beginning();
    this.camera.updateMatrixWorld();
    const right = new three.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const up = new three.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    const near = new three.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 2);
    const caster = new three.Raycaster();
    const toCamera = new three.Vector3();
    let place: three.Vector3 | null = null;
    for (const [height, depth] of placesToBegin) {
      const from = new three.Vector3()
        .addScaledVector(up, height * this.size)
        .addScaledVector(near, depth * this.size)
        .addScaledVector(right, this.size);
      caster.set(from, right.clone().negate());
      const hit = caster.intersectObject(this.anatomy)[0];
      if (!hit?.face) continue;
      const contact = hit.point.clone();
      place ??= contact.clone().addScaledVector(right, distance);
      // Best where the surface is looked at, and nothing is before it.
      if (Math.abs(hit.face.normal.dot(near)) < 0.4) continue;
      toCamera.copy(this.camera.position).sub(contact).normalize();
      caster.set(contact.clone().addScaledVector(toCamera, 0.01 * this.size), toCamera);
      if (caster.intersectObject(this.anatomy).length > 0) continue;
      place = contact.addScaledVector(right, distance);
      break;
    }
    place ??= right.clone().multiplyScalar(0.3 * this.size);
    this.keepInSight(place);
    return this.outside(place);
  }

  /** How far from what it keeps the tool begins. [mm] */
  private beginning(): number {
    return Math.min(10, 0.06 * this.size);
  }

  /** Leads the view back until a point is within it. */
  private keepInSight(point: three.Vector3): void {
    for (let i = 0; i < 40 && Math.abs(point.clone().project(this.camera).x) > this.room(); ++i) {
      this.camera.position.multiplyScalar(1.1);
      this.controls.maxDistance = Math.max(
        this.controls.maxDistance,
        this.camera.position.length(),
      );
      this.controls.update();
      this.camera.updateMatrixWorld();
    }
  }

  /** A place to begin before where a ray through the view meets the anatomy; null where none does. */
  placeBefore(x: number, y: number, kept: number): Vec3 | null {
    const caster = new three.Raycaster();
    caster.setFromCamera(new three.Vector2(x, y), this.camera);
    const hit = caster.intersectObject(this.anatomy)[0];
    if (!hit?.face) return null;
    const { normal } = hit.face;
    if (normal.dot(caster.ray.direction) > 0) normal.negate();
    return this.outside(hit.point.addScaledVector(normal, kept + this.beginning()));
  }

  protected arrange(moment: State): void {
    const hand = this.inside(moment.hand.place);
    const tip = this.inside(moment.flange.place);
    const seen = tip.distanceTo(this.camera.position);
    const radius = Math.max(this.toolRadius, smallestBall * seen);
    this.hand.place(hand, 1.3 * radius);
    this.tool.place(tip, radius);

    this.spring.stretch(hand, tip, 0.16 * radius, 0.1 * radius);

    const shown = moment.planes.slice(0, mostPlanes);
    this.planes.forEach((disc, i) => {
      const plane = shown[i];
      disc.visible = plane !== undefined;
      if (plane === undefined) return;
      const normal = new three.Vector3(...plane.normal);
      disc.position.copy(tip).addScaledVector(normal, plane.offset - this.toolRadius);
      disc.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), normal);
      disc.scale.setScalar(Math.max(4 * radius, 0.03 * seen));
    });
    this.edges.geometry.dispose();
    this.edges.geometry = new three.BufferGeometry().setFromPoints(
      shown.flatMap(({ triangle }) => this.outline(triangle)),
    );
  }

  /** The edges of a triangle, as pairs of points. */
  private outline(triangle: number): three.Vector3[] {
    const positions = this.anatomy.geometry.getAttribute("position");
    const corner = (i: number) =>
      new three.Vector3().fromBufferAttribute(
        positions,
        this.corners[3 * triangle + (i % 3)] as number,
      );
    return [0, 1, 1, 2, 2, 3].map(corner);
  }
}
