// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import type { ToolFacts, Vec3 } from "../engine/keepout.ts";
import { Capsule } from "../page/capsule.ts";
import type { CenteredSurface } from "../page/centered_surface.ts";
import { colorOf } from "../page/color_of.ts";
import type { Tissue } from "../page/tissue.ts";
import type { GuideKind } from "./guide_panel.ts";
import { GuideShapes } from "./guide_shapes.ts";
import { coloredWithin, MarginView } from "./margin_view.ts";
import { colors, sheet } from "./markers.ts";
import type { State } from "./protocol.ts";
import { Scene } from "./scene.ts";
import type { SecondTool } from "./second_tool.ts";
import type { StartLine } from "./start_place.ts";

/** The largest number of drawn active planes. */
const mostPlanes = 8;
/** Start positions of a tip to try: height in the view, and distance. [sizes of the anatomy] */
const placesToBegin = [0.3, 0.2, 0.1, 0].flatMap((near) =>
  [0.16, 0.08, 0.24, 0, -0.08].map((height) => [height, near] as const),
);
/** The smallest drawn radius of a ball, as a fraction of the visible size. */
const smallestBall = 0.006;
/** The initially visible width of the view, for an instrument. [mm] */
const seenAtFirst = 130;
/** The radius around the jaw of an instrument within which the hand can be grabbed. [mm] */
const gripRadius = 4;

/**
 * The anatomy with a tool, the commanded place of its last body, and the planes that limit the
 * motion of a tip. A tip is a tool of one body, a ball. RobotScene draws an instrument.
 */
export class ToolScene extends Scene {
  protected bodies: Capsule[] = [];
  protected radii: readonly number[] = [];
  protected wanted = new Capsule();
  private readonly planes = Array.from({ length: mostPlanes }, () => sheet(colors.plane));
  protected readonly guides = new GuideShapes();
  private readonly edges = new three.LineSegments(
    new three.BufferGeometry(),
    new three.LineBasicMaterial({ color: colors.plane, depthTest: false, transparent: true }),
  );
  private readonly margin: MarginView;
  private guard = { margin: 0, isGuarded: false };
  protected toolColor = "";
  protected alarm = "";
  /** The names of the bodies; none for a tip. */
  private names: readonly string[] = [];
  private second: SecondTool | null = null;
  /** True until the first view of an anatomy is chosen. */
  private isNew = true;

  /** `isBall`: true for a tip. */
  constructor(
    container: HTMLElement,
    room: () => number,
    onDraw: () => void,
    protected readonly isBall: boolean,
  ) {
    super(container, room, onDraw);
    this.moving.add(this.edges, ...this.planes, this.guides.group);
    this.spring.line.renderOrder = isBall ? 1 : 3;
    this.margin = new MarginView(container);
    this.moving.add(this.margin.group);
  }

  override show(surface: CenteredSurface, tissue: Tissue): void {
    this.isNew = true;
    this.margin.show(surface, tissue);
    super.show(surface, tissue);
  }

  /** Takes the margin, and whether a rule keeps it. [mm] */
  setMargin(margin: number, isGuarded: boolean): void {
    this.guard = { margin, isGuarded };
    this.redraw();
  }

  /** Gives tool and trail the color of a rule. */
  paintTool(color: string): void {
    this.toolColor = color;
    this.alarm = colorOf("--alarm");
    this.trail.paint(color);
    this.margin.paint(color);
    this.redraw();
  }

  /** Shows a second tip in a pane of its own, beside this one; null: one pane. */
  pair(second: SecondTool | null): void {
    this.second = second;
    this.beside = second?.scene ?? null;
    this.panes.count = second === null ? 1 : 2;
    this.resize();
  }

  /** Shows the second tip in this state. */
  updateSecond(state: State): void {
    this.second?.update(state, this.inside(state.flange.place));
    this.redraw();
  }

  /** Shows another tool, which has these properties. */
  equip({ bodies, guides }: ToolFacts): void {
    for (const body of [...this.bodies, this.wanted]) {
      this.moving.remove(...body.parts);
      body.dispose();
    }
    this.radii = bodies.map(({ radius }) => radius);
    this.names = this.isBall ? [] : bodies.map(({ name }) => name);
    // Created first, so that the hand is drawn below a tool at the same position.
    this.wanted = new Capsule(this.isBall ? 0.35 : 0.6);
    this.wanted.paint(colors.hand);
    this.bodies = bodies.map(() => new Capsule(this.isBall ? 1 : 0.4));
    this.moving.add(...[this.wanted, ...this.bodies].flatMap(({ parts }) => parts));
    this.toolRadius = this.isBall ? (this.radii[0] ?? 1) : gripRadius;
    this.guides.show(guides, (place) => this.inside(place), 0.4 * this.extent());
    this.redraw();
  }

  /**
   * Returns the text of a region near a position, in the size of the view. It is above the
   * position, across it in the view, or along the direction from there to the middle.
   */
  regionAbout(place: Vec3, kind: GuideKind): string {
    this.camera.updateMatrixWorld();
    const axis = (number: number) =>
      new three.Vector3().setFromMatrixColumn(this.camera.matrixWorld, number);
    const [right, up] = [axis(0), axis(1)];
    const at = new three.Vector3(...place);
    const text = (vector: three.Vector3, digits: number) =>
      vector
        .toArray()
        .map((value) => Number(value.toFixed(digits)))
        .join();
    const length = (share: number) => Number((share * this.extent()).toPrecision(2));
    switch (kind) {
      case "half_space":
        at.addScaledVector(up, -length(0.02));
        return `half_space:${text(at, 2)}:${text(up, 3)}`;
      case "slab":
        return `slab:${text(at, 2)}:${text(up, 3)}:${length(0.03)}`;
      case "tube":
        return `tube:${text(at, 2)}:${text(right, 3)}:${length(0.04)}`;
      case "ball":
        return `ball:${text(at, 2)}:${length(0.12)}`;
    }
  }

  /** Returns the initially visible size. [mm] */
  protected extent(): number {
    return this.isBall ? this.size : Math.min(this.size, seenAtFirst);
  }

  /** Turns the view of another anatomy to the tool. */
  protected firstView(moment: State): void {
    this.keepInSight(this.inside(moment.flange.place));
  }

  override update(moment: State): void {
    if (this.isNew) this.firstView(moment);
    this.isNew = false;
    super.update(moment);
  }

  /**
   * Returns lines on which a tip may start, the best first. They come across the view from the
   * right, and the first ones meet the anatomy where it is visible.
   */
  linesBeside(): StartLine[] {
    this.camera.updateMatrixWorld();
    const [right, up, near] = [0, 1, 2].map((axis) =>
      new three.Vector3().setFromMatrixColumn(this.camera.matrixWorld, axis),
    ) as [three.Vector3, three.Vector3, three.Vector3];
    const caster = new three.Raycaster();
    const toCamera = new three.Vector3();
    const good: StartLine[] = [];
    const others: StartLine[] = [];
    for (const [height, depth] of placesToBegin) {
      const from = new three.Vector3()
        .addScaledVector(up, height * this.size)
        .addScaledVector(near, depth * this.size)
        .addScaledVector(right, this.size);
      caster.set(from, right.clone().negate());
      const hit = caster.intersectObject(this.anatomy)[0];
      if (!hit?.face) continue;
      const contact = hit.point.clone();
      const line = { from: this.outside(from), to: this.outside(contact) };
      others.push(line);
      // Skips places that the view shows at a steep angle or that something hides.
      if (Math.abs(hit.face.normal.dot(near)) < 0.4) continue;
      toCamera.copy(this.camera.position).sub(contact).normalize();
      caster.set(contact.clone().addScaledVector(toCamera, 0.01 * this.size), toCamera);
      if (caster.intersectObject(this.anatomy).length === 0) good.push(line);
    }
    // A vertex, for a surface that no line across the view meets.
    const vertex = new three.Vector3().fromBufferAttribute(
      this.anatomy.geometry.getAttribute("position"),
      0,
    );
    const beside = right.clone().multiplyScalar(this.size);
    others.push({ from: this.outside(beside), to: this.outside(vertex) });
    // Through a cavity whose outside is forbidden.
    others.push({ from: this.outside(beside), to: this.outside(beside.clone().negate()) });
    return [...good, ...others];
  }

  /** Returns the line from the eye to the anatomy in a direction of the view; null if it misses. */
  lineBefore(x: number, y: number): StartLine | null {
    const caster = new three.Raycaster();
    caster.setFromCamera(new three.Vector2(x, y), this.camera);
    const hit = caster.intersectObject(this.anatomy)[0];
    if (hit === undefined) return null;
    return { from: this.outside(this.camera.position), to: this.outside(hit.point) };
  }

  /** Returns the directions from a place to the nearest surface, and along it: up or right in the view. */
  ontoSurface(place: Vec3): { towards: Vec3; across: Vec3 } {
    const at = this.inside(place);
    const towards = this.margin.nearestTo(at).sub(at).normalize();
    const [right, up] = [this.across(1, 0, 0), this.across(0, 1, 0)].map((way) =>
      new three.Vector3(...way).projectOnPlane(towards),
    ) as [three.Vector3, three.Vector3];
    const across = (up.length() > 0.5 ? up : right).normalize();
    return { towards: towards.toArray(), across: across.toArray() };
  }

  /** Returns the initial distance of a tip from its required clearance. [mm] */
  beginning(): number {
    return Math.min(10, 0.06 * this.size);
  }

  /** The diagonal of the anatomy's box. [mm] */
  get diagonal(): number {
    return this.size;
  }

  /** Moves the view back until a point is in its open part. */
  protected keepInSight(point: three.Vector3): void {
    const { camera, controls } = this;
    for (let i = 0; i < 40; ++i) {
      camera.updateMatrixWorld();
      const { x, y } = point.clone().project(camera);
      const open = this.openView();
      if (Math.abs(x) <= open.x && Math.abs(y) <= open.y) return;
      const away = camera.position.clone().sub(controls.target).multiplyScalar(1.1);
      controls.maxDistance = Math.max(controls.maxDistance, away.length());
      camera.position.copy(controls.target).add(away);
      controls.update();
    }
  }

  protected arrange(moment: State): void {
    const { hand, flange, cores } = moment;
    const [tip, wish] = [this.inside(flange.place), this.inside(hand.place)];
    const seen = tip.distanceTo(this.camera.position);
    const last = this.bodies.length - 1;
    const radiusOf = (body: number) =>
      Math.max(this.radii[body] ?? 0, this.isBall ? smallestBall * seen : 0);
    this.bodies.forEach((body, i) => {
      body.place(this.pointOf(cores, 2 * i), this.pointOf(cores, 2 * i + 1), radiusOf(i));
      body.paint(this.toolColor);
    });

    // The last body is fixed in the frame of the flange, and in that of the hand.
    const turn = new three.Quaternion(...hand.turn).multiply(
      new three.Quaternion(...flange.turn).invert(),
    );
    const [from, to] = [2 * last, 2 * last + 1].map((end) =>
      this.pointOf(cores, end).sub(tip).applyQuaternion(turn).add(wish),
    ) as [three.Vector3, three.Vector3];
    const radius = radiusOf(last);
    this.wanted.place(from, to, (this.isBall ? 1.3 : 1.25) * radius);
    this.wanted.show(this.isBall || wish.distanceTo(tip) > 0.3 || Math.abs(turn.w) < 0.9995);
    const [wide, least] = this.isBall ? [0.16 * radius, 0.1 * radius] : [0.35, 0.3];
    this.spring.stretch(wish, tip, wide, least);
    this.showPlanes(moment, tip, Math.max(2.2 * radius, 0.02 * seen));
    this.guides.mark(moment.guides);
    if (this.panes.count === 1) {
      this.showMargin(
        moment,
        this.bodies.map((_, i) => radiusOf(i)),
      );
    } else this.margin.hide();
    const other = this.second?.state;
    if (!other) return;
    const crossed = other.crossedAt && this.inside(other.crossedAt);
    const [otherTip, otherHand] = [other.flange.place, other.hand.place].map((place) =>
      this.inside(place),
    );
    this.second?.arrange(
      otherTip as three.Vector3,
      otherHand as three.Vector3,
      radiusOf(last),
      crossed,
    );
  }

  /** `drawn`: the drawn radius of each body. */
  protected showMargin({ cores, clearances, held, byMesh }: State, drawn: readonly number[]): void {
    const bodies = this.radii.map((radius, i) => ({
      from: this.pointOf(cores, 2 * i),
      to: this.pointOf(cores, 2 * i + 1),
      radius,
    }));
    const isHeld = held > 0 && byMesh;
    const { names } = this;
    const tool = { ...this.guard, bodies, names, clearances, isHeld };
    this.margin.update(tool, this.camera, drawn);
    const sun = new three.Vector3(-0.45, 0.62, 0.64).transformDirection(this.camera.matrixWorld);
    this.shade.place(bodies, sun, coloredWithin(this.size), this.alarm);
  }

  /**
   * Shows the planes that limited the motion of a tip as discs, and the edges of their triangles.
   */
  private showPlanes({ planes, motion }: State, tip: three.Vector3, size: number): void {
    // A plane of a guide has no triangle, and is drawn with its guide.
    const triangles = this.corners.length / 3;
    const shown = planes.filter(({ triangle }) => triangle < triangles).slice(0, mostPlanes);
    this.planes.forEach((disc, i) => {
      const plane = shown[i];
      disc.visible = plane !== undefined;
      if (plane === undefined) return;
      const normal = new three.Vector3(...plane.normal);
      // The offset is relative to the tip before the motion.
      const made = normal.dot(new three.Vector3(...motion));
      disc.position.copy(tip).addScaledVector(normal, plane.offset - made - this.toolRadius);
      disc.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), normal);
      disc.scale.setScalar(size);
    });
    this.edges.geometry.dispose();
    this.edges.geometry = new three.BufferGeometry().setFromPoints(
      shown.flatMap(({ triangle }) => this.outline(triangle)),
    );
  }

  /** Returns the edges of a triangle, as pairs of points. */
  private outline(triangle: number): three.Vector3[] {
    const positions = this.anatomy.geometry.getAttribute("position");
    const corner = (i: number) =>
      new three.Vector3().fromBufferAttribute(
        positions,
        this.corners[3 * triangle + (i % 3)] as number,
      );
    return [0, 1, 1, 2, 2, 3].map(corner);
  }

  /** Returns a point of a list of positions, three numbers each. */
  protected pointOf(places: readonly number[], i: number): three.Vector3 {
    return this.inside(places.slice(3 * i, 3 * i + 3) as unknown as Vec3);
  }
}
