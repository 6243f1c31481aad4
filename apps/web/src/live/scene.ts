// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Vec3 } from "../engine/keepout.ts";
import { anatomyMaterial, paintTissue } from "../page/anatomy_material.ts";
import type { CenteredSurface } from "../page/centered_surface.ts";
import { makeGraphics, setShading, surfaceGeometry } from "../page/graphics.ts";
import { PictureQuality } from "../page/picture_quality.ts";
import type { Shading } from "../page/shading.ts";
import { StillPicture } from "../page/still_picture.ts";
import { type Tissue, tissues } from "../page/tissue.ts";
import { ToolShade } from "../page/tool_shade.ts";
import { Spring, Trail } from "./markers.ts";
import { type Area, Panes } from "./panes.ts";
import type { State } from "./protocol.ts";
import type { Pinch } from "./two_fingers.ts";
import { ViewMotion } from "./view_motion.ts";

/** The anatomy with the hand and a tool, which a derived class draws. */
export abstract class Scene {
  readonly camera = new three.PerspectiveCamera(32, 1, 0.1, 10_000);
  /** The parts of the view, all seen by the same camera; the tool is in the last one. */
  readonly panes: Panes;
  /** Drawn in the first of two panes, instead of the moving parts. */
  protected beside: three.Scene | null = null;
  private readonly renderer: three.WebGLRenderer;
  protected readonly controls: OrbitControls;
  /** Moves the view by keys and by two fingers. */
  readonly motion: ViewMotion;
  private readonly still: StillPicture;
  protected readonly anatomy: three.Mesh<three.BufferGeometry, three.ShaderMaterial>;
  protected readonly moving = new three.Scene();
  protected readonly spring = new Spring();
  protected readonly trail = new Trail();
  /** The displayed state; null: no tool yet. */
  private moment: State | null = null;
  private readonly lit: three.Group[] = [];
  protected readonly shade = new ToolShade();
  private readonly quality: PictureQuality;
  protected corners = new Uint32Array();
  private origin = new three.Vector3();
  protected size = 100; // of the anatomy's box: its diagonal [mm]
  protected toolRadius = 1;
  private isDue = false;
  private drawn = 0;

  /**
   * Draws into a container, and again after each change. `room`: the fraction of its width that is
   * not covered, in the middle.
   */
  constructor(
    protected readonly container: HTMLElement,
    protected readonly room: () => number,
    private readonly onDraw: () => void,
  ) {
    // The still picture smooths its own edges.
    const { renderer, isSlow } = makeGraphics(false);
    this.renderer = renderer;
    this.quality = new PictureQuality(isSlow ? 1 : 0);
    this.renderer.domElement.id = "picture";
    container.prepend(this.renderer.domElement);
    this.panes = new Panes(container);
    this.camera.up.set(0, 0, 1);

    const light = new three.Scene();
    this.anatomy = new three.Mesh(new three.BufferGeometry(), anatomyMaterial(tissues.shape, null));
    this.anatomy.frustumCulled = false;
    light.add(this.anatomy);
    this.still = new StillPicture(light, this.camera, 0, this.shade);

    this.moving.add(this.lights(), this.spring.line, this.trail.line);
    this.moving.visible = false;

    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.motion = new ViewMotion(this.camera, this.controls);
    this.renderer.domElement.addEventListener("webglcontextrestored", () => this.outdate());
    this.controls.addEventListener("change", () => this.outdate());
    new ResizeObserver(() => this.resize()).observe(container);
    this.resize();
  }

  /** Frames drawn since the beginning. */
  get frames(): number {
    return this.drawn;
  }

  /** Shows another anatomy from one side, in the size of the view. */
  show({ positions, corners, origin, size }: CenteredSurface, tissue: Tissue): void {
    paintTissue(this.anatomy.material, tissue);
    this.anatomy.geometry.dispose();
    this.anatomy.geometry = surfaceGeometry(positions, corners);
    this.corners = corners;
    this.origin.set(...origin);
    this.size = size;
    this.controls.minDistance = 0.02 * this.size;
    this.controls.maxDistance = 4 * this.size;
    this.controls.target.set(0, 0, 0);
    this.camera.position.set(-0.15, 0.95, 0.16).setLength(this.size);
    this.controls.update();
    this.anatomy.geometry.computeBoundingBox();
    this.fit(this.boxCorners());
    this.clear();
    this.resize();
  }

  /** Refines the shading of the shown anatomy. */
  refine(shading: Shading): void {
    setShading(this.anatomy.geometry, shading);
    this.outdate();
  }

  /** Shows this state from now on. */
  update(moment: State): void {
    const { place } = moment.flange;
    if (moment.placed !== this.moment?.placed) this.trail.clear();
    if (this.moment?.flange.place.some((value, i) => value !== place[i])) {
      this.trail.add(this.inside(place));
    }
    this.moment = moment;
    this.moving.visible = true;
    this.redraw();
  }

  /**
   * Returns the place at the same depth that is in the open part of the view, which no card covers.
   * A place outside of it goes no farther out than `from`.
   */
  inOpenView(place: Vec3, from: Vec3): Vec3 {
    const wanted = this.project(place);
    const begin = this.project(from);
    const open = this.openView();
    const within = (value: number, most: number, now: number) =>
      Math.min(Math.max(value, Math.min(-most, now)), Math.max(most, now));
    const x = within(wanted.x, open.x, begin.x);
    const y = within(wanted.y, open.y, begin.y);
    if (x === wanted.x && y === wanted.y) return place;
    return this.outside(new three.Vector3(x, y, wanted.z).unproject(this.camera));
  }

  /** Returns half the width and height of the open part, in those of the view. */
  openView(): { x: number; y: number } {
    // With two panes no card covers the view; at the top of each pane are its readings.
    if (this.panes.count === 2)
      return { x: 0.9, y: Math.max(1 - 130 / this.panes.area().height, 0.4) };
    return { x: this.room(), y: Math.max(1 - 60 / this.container.clientHeight, 0.3) };
  }

  /** Returns the corners of the box around the anatomy. */
  protected boxCorners(): three.Vector3[] {
    const { min, max } = this.anatomy.geometry.boundingBox ?? new three.Box3();
    return [min.x, max.x].flatMap((x) =>
      [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => new three.Vector3(x, y, z))),
    );
  }

  /** Moves the camera along its direction until all points are just within the open view. */
  protected fit(points: readonly three.Vector3[]): void {
    const { camera, controls } = this;
    const open = this.openView();
    for (let i = 0; i < 12; ++i) {
      camera.updateMatrixWorld();
      const most = Math.max(
        ...points.map((point) => {
          const { x, y } = point.clone().project(camera);
          return Math.max(Math.abs(x) / open.x, Math.abs(y) / open.y);
        }),
      );
      const away = camera.position
        .clone()
        .sub(controls.target)
        .multiplyScalar(1.02 * most);
      camera.position.copy(controls.target).add(away);
      controls.update();
    }
  }

  /** Turns the camera to a place without turning the view. */
  lookAt(place: Vec3): void {
    const way = this.inside(place).sub(this.controls.target);
    this.controls.target.add(way);
    this.camera.position.add(way);
    this.controls.update();
  }

  /** Turns and zooms the view about a place. */
  pinch(place: Vec3, { spread, twist }: Pinch): void {
    this.motion.zoom(spread, this.inside(place));
    this.motion.turn(twist, 0, this.inside(place));
  }

  /** Returns the radius of the tool's ball in the view. [px] */
  ballRadius(place: Vec3): number {
    const depth = this.inside(place).distanceTo(this.camera.position);
    const halfHeight = depth * Math.tan((0.5 * this.camera.fov * Math.PI) / 180);
    return (0.5 * this.panes.area().height * this.toolRadius) / halfHeight;
  }

  /** Returns the position in the view, from -1 to 1 in both directions, and the depth. */
  project(place: Vec3): three.Vector3 {
    return this.inside(place).project(this.camera);
  }

  /** Like project(), but as a CSS translation from the upper left of the view, in one of its panes. */
  shift(place: Vec3, pane = this.panes.count - 1): string {
    const { x, y } = this.project(place);
    const { x: left, y: top, width, height } = this.panes.area(pane);
    return `translate(${left + 0.5 * (1 + x) * width}px, ${top + 0.5 * (1 - y) * height}px)`;
  }

  /** Looks at a place from a direction, and from so far that a length fits into a pane. [mm] */
  lookFrom(place: Vec3, direction: Vec3, length: number): void {
    const halfAngle = (0.5 * this.camera.fov * Math.PI) / 180;
    const distance = length / (2 * Math.tan(halfAngle) * Math.min(1, this.camera.aspect));
    this.controls.target.copy(this.inside(place));
    this.camera.position
      .set(...direction)
      .normalize()
      .multiplyScalar(distance)
      .add(this.controls.target);
    this.controls.update();
  }

  /** Returns the position under a point of the view, at the depth of another position. */
  unproject(x: number, y: number, depthOf: Vec3): Vec3 {
    const depth = this.inside(depthOf).project(this.camera).z;
    return this.outside(new three.Vector3(x, y, depth).unproject(this.camera));
  }

  /** Returns a motion given along the axes of the view: right, up, and into it. [mm] */
  across(right: number, up: number, into: number): Vec3 {
    return new three.Vector3(right, up, -into)
      .transformDirection(this.camera.matrixWorld)
      .multiplyScalar(Math.hypot(right, up, into))
      .toArray() as Vec3;
  }

  /** Draws with the browser's next frame. */
  redraw(): void {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame((begin) => {
      this.isDue = false;
      this.draw();
      requestAnimationFrame((end) => {
        if (this.quality.add(end - begin)) this.resize();
      });
    });
  }

  /** Moves the view back until a point is in its open part. */
  protected abstract keepInSight(point: three.Vector3): void;

  /** Positions the moving parts. */
  protected abstract arrange(moment: State): void;

  /** Shows no tool until the next update. */
  private clear(): void {
    this.moment = null;
    this.moving.visible = false;
    this.trail.clear();
  }

  private draw(): void {
    this.fitDepths();
    for (const lights of this.lit) lights.quaternion.copy(this.camera.quaternion);
    if (this.moment !== null) this.arrange(this.moment);
    const areas = this.panes.areas();
    areas.forEach((area, i) => {
      this.choose(area);
      this.still.draw(this.renderer);
      const moving = i < areas.length - 1 ? this.beside : this.moving;
      if (moving !== null) this.renderer.render(moving, this.camera);
    });
    ++this.drawn;
    this.onDraw();
  }

  /** Draws from now on into this part of the view only. */
  private choose({ x, y, width, height }: Area): void {
    const part = [x, this.container.clientHeight - y - height, width, height] as const;
    this.renderer.setViewport(...part);
    this.renderer.setScissor(...part);
    this.renderer.setScissorTest(true);
  }

  /** Sets the range of visible depths, so that it holds the anatomy and a tool beside it. */
  private fitDepths(): void {
    const away = this.camera.position.length() + this.size;
    const near = 0.002 * Math.min(this.size, away);
    const far = 2 * away + 10 * this.size;
    if (this.camera.near === near && this.camera.far === far) return;
    this.camera.near = near;
    this.camera.far = far;
    this.camera.updateProjectionMatrix();
    this.still.outdate();
  }

  protected resize(): void {
    const { clientWidth: width, clientHeight: height } = this.container;
    if (width === 0 || height === 0) return;
    const { name, scale, samples, shade } = this.quality.quality;
    this.container.dataset.picture = name;
    const pane = this.panes.area();
    // The shade of one tool would show on the anatomy of both.
    this.still.adjust(samples, shade && this.panes.count === 1);
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2, scale * devicePixelRatio));
    this.renderer.setSize(width, height);
    this.camera.aspect = pane.width / pane.height;
    this.camera.updateProjectionMatrix();
    if (this.moment !== null) this.keepInSight(this.inside(this.moment.flange.place));
    this.outdate();
  }

  /** Draws the anatomy again as well. */
  private outdate(): void {
    this.still.outdate();
    this.redraw();
  }

  /** Returns lights that are fixed to the view: from its upper left, and faintly from all sides. */
  private lights(): three.Group {
    const group = new three.Group();
    const sky = new three.HemisphereLight("#ffffff", "#6b6259", 0.9);
    const key = new three.DirectionalLight("#fff3e2", 2.6);
    key.position.set(-0.9, 1.1, 0.9);
    const rim = new three.DirectionalLight("#cfe2ff", 0.7);
    rim.position.set(1.6, 0.1, 0.1);
    group.add(sky, key, rim);
    this.lit.push(group);
    return group;
  }

  /**
   * Maps from the frame of the mesh to that of the scene, whose origin is the middle of the
   * anatomy.
   */
  protected inside(place: Vec3): three.Vector3 {
    return new three.Vector3(...place).sub(this.origin);
  }

  protected outside(point: three.Vector3): Vec3 {
    return point.clone().add(this.origin).toArray() as Vec3;
  }
}
