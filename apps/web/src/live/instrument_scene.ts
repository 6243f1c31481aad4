// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import type { Vec3 } from "../engine/keepout.ts";
import type { ToolFacts } from "../engine/tool.ts";
import type { CenteredSurface } from "../page/centered_surface.ts";
import { Capsule, colors } from "./markers.ts";
import type { State } from "./protocol.ts";
import { heldBody } from "./readings.ts";
import { Scene } from "./scene.ts";

/** How much of the instrument is seen at first, across the view. [mm] */
const seenAtFirst = 130;
/** Its jaw has the colour of the tool, the bodies before it are of steel. */
const steel = "#8d9db5";

/** The anatomy, and in it an instrument, and where the hand wants its jaw. */
export class InstrumentScene extends Scene {
  private bodies: Capsule[] = [];
  private wanted: Capsule | null = null;
  private readonly port = new three.Mesh(
    new three.TorusGeometry(9, 1.6, 12, 40),
    new three.MeshStandardMaterial({ color: steel, roughness: 0.5 }),
  );
  /** Whether the view is still to be turned to the jaw. */
  private isNew = true;

  constructor(container: HTMLElement, room: () => number, onDraw: () => void) {
    super(container, room, onDraw);
    this.moving.add(this.port);
    this.spring.line.renderOrder = 3;
    this.toolRadius = 4; // which is held by its jaw
  }

  override show(surface: CenteredSurface): void {
    this.isNew = true;
    super.show(surface);
  }

  equip({ bodies }: ToolFacts): void {
    for (const body of [...this.bodies, this.wanted]) {
      if (body === null) continue;
      this.moving.remove(...body.parts);
      body.dispose();
    }
    const last = bodies.length - 1;
    this.bodies = bodies.map(
      ({ radius }, i) => new Capsule(radius, i === last ? colors.tool : steel, 1),
    );
    this.wanted = new Capsule(1.25 * (bodies[last]?.radius ?? 1), colors.hand, 0.6);
    this.moving.add(...[...this.bodies, this.wanted].flatMap(({ parts }) => parts));
    this.clear();
  }

  override update(moment: State): void {
    if (this.isNew) this.lookAtJaw(moment);
    this.isNew = false;
    super.update(moment);
  }

  /**
   * Looks at the jaw from beside the shaft, whence the anatomy hides as little as can be; of such
   * places the highest.
   */
  private lookAtJaw({ cores, flange }: State): void {
    const tip = this.inside(flange.place);
    const port = this.inside(cores.slice(0, 3) as unknown as Vec3);
    const back = port.clone().sub(tip).normalize();
    const aside = new three.Vector3(-back.y, back.x, 0);
    if (aside.lengthSq() < 1e-6) aside.set(1, 0, 0);
    aside.normalize();
    const up = back.clone().cross(aside);
    const distance =
      (seenAtFirst / (2 * Math.tan((0.5 * this.camera.fov * Math.PI) / 180))) *
      Math.max(1, 0.8 / (this.camera.aspect * this.room()));
    const caster = new three.Raycaster();
    const seen = (from: three.Vector3) =>
      [0, 0.3, 0.8].filter((share) => {
        const point = tip.clone().lerp(port, share);
        const way = from.clone().sub(point);
        caster.far = way.length();
        caster.set(point, way.normalize());
        return caster.intersectObject(this.anatomy).length === 0;
      }).length;
    const places = [0, 1, 2, 3, 4, 5, 6, 7]
      .map((eighth) => {
        const angle = (eighth * Math.PI) / 4;
        const way = aside.clone().multiplyScalar(Math.cos(angle));
        way.addScaledVector(up, Math.sin(angle)).addScaledVector(back, 0.5).normalize();
        return tip.clone().addScaledVector(way, distance);
      })
      .sort((a, b) => b.z - a.z);
    let [best, most] = [places[0] as three.Vector3, -1];
    for (const place of places) {
      const count = seen(place);
      if (count > most) [best, most] = [place, count];
      if (count === 3) break;
    }
    this.controls.target.copy(tip).lerp(port, 0.12);
    this.camera.position.copy(best);
    this.controls.update();
  }

  protected arrange(moment: State): void {
    if (this.wanted === null) return;
    const { hand, flange, cores } = moment;
    const held = heldBody(moment);
    const point = (i: number) => this.inside(cores.slice(3 * i, 3 * i + 3) as unknown as Vec3);
    const last = this.bodies.length - 1;
    this.bodies.forEach((body, i) => {
      body.place(point(2 * i), point(2 * i + 1));
      body.paint(i === held ? colors.plane : i === last ? colors.tool : steel);
    });

    // The jaw does not move in the frame of the flange, nor in that of the hand.
    const tip = this.inside(flange.place);
    const wish = this.inside(hand.place);
    const turn = new three.Quaternion(...hand.turn).multiply(
      new three.Quaternion(...flange.turn).invert(),
    );
    const moved = (at: three.Vector3) => at.sub(tip).applyQuaternion(turn).add(wish);
    this.wanted.show(wish.distanceTo(tip) > 0.3 || Math.abs(turn.w) < 0.9995);
    this.wanted.place(moved(point(2 * last)), moved(point(2 * last + 1)));
    this.spring.stretch(wish, tip, 0.35, 0.3);

    this.port.position.copy(point(0));
    const along = point(1).sub(point(0)).normalize();
    this.port.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), along);
  }
}
