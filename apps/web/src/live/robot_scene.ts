// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import type { ToolFacts, Vec3 } from "../engine/keepout.ts";
import { Capsule } from "../page/capsule.ts";
import type { CenteredSurface } from "../page/centered_surface.ts";
import type { Tissue } from "../page/tissue.ts";
import { colors } from "./markers.ts";
import type { State } from "./protocol.ts";
import { InstrumentParts } from "./robot_parts.ts";
import { firstJaw } from "./robot_surroundings.ts";
import { ToolScene } from "./tool_scene.ts";

/** The visible width of the close-up. [mm] */
const closeWidth = 64;
/** The length above the port that the first view contains. [mm] */
const seenAbovePort = 45;
/** The direction of the first view, which is that of a tip's page, and others that are tried: turns about z. */
const firstTurns = [0, 0.6, -0.6, 1.2, -1.2, 1.9, -1.9, 2.6, -2.6] as const;
/** The most that the hand can be pushed past the jaw, along the view. [mm] */
const mostAhead = 12;

/**
 * The anatomy with a da Vinci instrument: what is drawn of it in the body lies within the capsules
 * that keepout guards. The capsule of a body that meets the surface is shown around it. The hand
 * is shown as red jaws.
 */
export class RobotScene extends ToolScene {
  private readonly parts = new InstrumentParts();
  private wishes: Capsule[] = [];
  private now: State | null = null;
  private isPortLaid = false;

  constructor(container: HTMLElement, room: () => number, onDraw: () => void) {
    super(container, room, onDraw, false);
    this.moving.add(...this.parts.guarded, ...this.parts.unguarded);
  }

  override show(surface: CenteredSurface, tissue: Tissue): void {
    this.isPortLaid = false;
    super.show(surface, tissue);
  }

  override paintTool(color: string): void {
    this.parts.paint(color);
    super.paintTool(color);
  }

  override equip(facts: ToolFacts): void {
    super.equip(facts);
    this.wanted.show(false);
    for (const [hidden] of this.bodies.map(({ parts }) => parts)) beforeAll(hidden);
    for (const wish of this.wishes) {
      this.moving.remove(...wish.parts);
      wish.dispose();
    }
    this.wishes = facts.bodies.slice(firstJaw).map(() => new Capsule(0.6));
    this.moving.add(...this.wishes.flatMap(({ parts }) => parts));
  }

  override update(moment: State): void {
    this.now = moment;
    super.update(moment);
  }

  /** Like Scene.inOpenView, but keys and wheel push the hand only a little past the jaw. */
  override inOpenView(place: Vec3, from: Vec3): Vec3 {
    const open = super.inOpenView(place, from);
    if (this.now === null) return open;
    const into = this.across(0, 0, 1);
    const jaw = this.now.flange.place;
    const ahead = (at: Vec3) =>
      at.reduce((sum, value, i) => sum + (value - (jaw[i] as number)) * (into[i] as number), 0);
    const [wanted, begin] = [ahead(open), ahead(from)];
    const allowed = Math.min(
      Math.max(wanted, Math.min(-mostAhead, begin)),
      Math.max(mostAhead, begin),
    );
    return open.map(
      (value, i) => value + (allowed - wanted) * (into[i] as number),
    ) as unknown as Vec3;
  }

  /** Shows all of it: the anatomy, the port, and the instrument down to its tip. */
  showAll(): void {
    if (this.now === null) return;
    const { tip, port, outwards } = this.placesOf(this.now);
    const above = port.clone().addScaledVector(outwards, seenAbovePort);
    const points = [tip, above, ...this.boxCorners()];
    const target = new three.Box3().setFromPoints(points).getCenter(new three.Vector3());
    const ways = firstTurns.map((turn) =>
      new three.Vector3(-0.15, 0.95, 0.28)
        .normalize()
        .applyAxisAngle(new three.Vector3(0, 0, 1), turn),
    );
    const away = 3 * this.size;
    const way = this.clearest(ways.map((one) => target.clone().addScaledVector(one, away)));
    this.look(target, way);
    this.fit(points);
  }

  /** Shows the jaws, from the side on which the anatomy hides the instrument least. */
  showJaws(): void {
    if (this.now === null) return;
    const { tip, port, outwards } = this.placesOf(this.now);
    const aside = new three.Vector3(-outwards.y, outwards.x, 0);
    if (aside.lengthSq() < 1e-6) aside.set(1, 0, 0);
    aside.normalize();
    const up = outwards.clone().cross(aside);
    const distance =
      (closeWidth / (2 * Math.tan((0.5 * this.camera.fov * Math.PI) / 180))) *
      Math.max(1, 0.8 / (this.camera.aspect * this.room()));
    const places = [0, 1, 2, 3, 4, 5, 6, 7]
      .map((eighth) => {
        const angle = (eighth * Math.PI) / 4;
        const way = aside.clone().multiplyScalar(Math.cos(angle));
        way.addScaledVector(up, Math.sin(angle)).addScaledVector(outwards, 0.5).normalize();
        return tip.clone().addScaledVector(way, distance);
      })
      .sort((a, b) => b.z - a.z);
    const place = this.clearest(places);
    this.look(tip.clone().lerp(port, 0.08), place);
  }

  protected override firstView(): void {
    this.showAll();
  }

  protected override arrange(moment: State): void {
    const { hand, flange, cores, clearances, surroundings } = moment;
    const { tip, port, pitch, yaw, ends, outwards } = this.placesOf(moment);
    const axis = new three.Vector3(1, 0, 0).applyQuaternion(new three.Quaternion(...flange.turn));
    this.parts.place({ port, pitch, yaw, ends, axis });
    if (!this.isPortLaid) this.parts.layPort(port, outwards);
    this.isPortLaid = true;

    const contact = surroundings?.contact ?? null;
    const { alarm } = this;
    this.bodies.forEach((body, i) => {
      body.place(this.pointOf(cores, 2 * i), this.pointOf(cores, 2 * i + 1), this.radii[i] ?? 0);
      const isIn = (clearances[i] as number) < 0;
      const usual = i < firstJaw ? colors.steel : this.toolColor;
      const isReached = i === contact?.body;
      body.paint(isIn ? alarm : isReached ? colors.plane : usual, isIn ? 0.6 : 0.3);
      const [, visible] = body.parts;
      if (visible) visible.visible = isIn || isReached;
    });

    const wish = this.inside(hand.place);
    const turn = new three.Quaternion(...hand.turn).multiply(
      new three.Quaternion(...flange.turn).invert(),
    );
    const moved = (point: three.Vector3) => point.clone().sub(tip).applyQuaternion(turn).add(wish);
    const isAway = wish.distanceTo(tip) > 0.3 || Math.abs(turn.w) < 0.9995;
    this.wishes.forEach((jaw, i) => {
      jaw.place(
        moved(yaw),
        moved(ends[i] as three.Vector3),
        1.25 * (this.radii[firstJaw + i] ?? 0),
      );
      jaw.paint(colors.hand);
      jaw.show(isAway);
    });
    this.spring.stretch(wish, tip, 0.35, 0.3);

    this.showMargin(moment, this.radii);
    this.guides.mark(moment.guides);
  }

  /** Returns the places of an instrument in the scene. */
  private placesOf({ cores, flange }: State) {
    const [port, pitch] = [this.pointOf(cores, 0), this.pointOf(cores, 1)];
    const yaw = this.pointOf(cores, 3);
    const jaws = cores.length / 6 - firstJaw;
    const ends = Array.from({ length: jaws }, (_, i) =>
      this.pointOf(cores, 2 * (firstJaw + i) + 1),
    );
    const outwards = port.clone().sub(pitch).normalize();
    return { tip: this.inside(flange.place), port, pitch, yaw, ends, outwards };
  }

  /** Returns the place from which most of tip, shaft and port is visible; the first of equal ones. */
  private clearest(places: readonly three.Vector3[]): three.Vector3 {
    const { tip, port } = this.placesOf(this.now as State);
    const caster = new three.Raycaster();
    const points = [0, 0.3, 0.8].map((share) => tip.clone().lerp(port, share));
    let [best, most] = [places[0] as three.Vector3, -1];
    for (const place of places) {
      const count = points.filter((point) => {
        const way = place.clone().sub(point);
        caster.far = way.length();
        caster.set(point, way.normalize());
        return caster.intersectObject(this.anatomy).length === 0;
      }).length;
      if (count > most) [best, most] = [place, count];
      if (count === points.length) break;
    }
    return best;
  }

  private look(target: three.Vector3, from: three.Vector3): void {
    this.controls.maxDistance = Math.max(this.controls.maxDistance, 6 * this.size);
    this.controls.minDistance = 10;
    this.controls.target.copy(target);
    this.camera.position.copy(from);
    this.controls.update();
    this.redraw();
  }
}

/** Lets a translucent part be drawn first, so that only the anatomy counts as what hides it. */
function beforeAll(part: Capsule["parts"][number] | undefined): void {
  if (part === undefined) return;
  part.material.transparent = false;
  part.material.blending = three.CustomBlending;
  part.renderOrder = -1;
}
