// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Plane, Vec3 } from "../engine/keepout.ts";
import { StillPicture } from "./still_picture.ts";

export const colors = {
  hand: "#e5484d",
  tool: "#2f7df6",
  plane: "#0fb5a3",
  bone: "#e9dfce",
} as const;

/** What is seen of a moment. */
export interface Moment {
  readonly hand: Vec3;
  readonly tip: Vec3;
  readonly planes: readonly Plane[];
}

/** How many active planes are drawn at most. */
const mostPlanes = 8;
/** Points of a trail: some seconds. */
const trailLength = 240;
/** A ball that is smaller than this share of what is seen is drawn as large. */
const smallestBall = 0.006;

/** The anatomy, and in it the hand, the tool and what holds the tool back. */
export class Scene {
  readonly camera = new three.PerspectiveCamera(32, 1, 0.1, 10_000);
  private readonly renderer: three.WebGLRenderer;
  private readonly controls: OrbitControls;
  private readonly still: StillPicture;
  private readonly anatomy: three.Mesh<three.BufferGeometry, three.MeshStandardMaterial>;
  private readonly moving = new three.Scene();
  private readonly hand = new Ball(colors.hand);
  private readonly tool = new Ball(colors.tool);
  private readonly spring: three.Mesh<three.CylinderGeometry, three.MeshBasicMaterial>;
  private readonly planes: three.Group[] = [];
  private readonly edges = new three.LineSegments(
    new three.BufferGeometry(),
    new three.LineBasicMaterial({ color: colors.plane, depthTest: false, transparent: true }),
  );
  private readonly trail = new Trail(colors.tool);
  private corners = new Uint32Array();
  private origin = new three.Vector3();
  private size = 100; // of the anatomy's box: its diagonal [mm]
  private toolRadius = 1;
  private moment: Moment | null = null;
  private isDue = false;
  private drawn = 0;

  /** Draws into a container, and again whenever something in it changes. */
  constructor(
    private readonly container: HTMLElement,
    private readonly onDraw: () => void,
  ) {
    // Smooth edges where a graphics processor draws; without one they would take too long.
    const canvas = document.createElement("canvas");
    const antialias = canvas.getContext("webgl2", { failIfMajorPerformanceCaveat: true }) !== null;
    this.renderer = new three.WebGLRenderer({ antialias, alpha: true });
    this.renderer.autoClear = false;
    this.renderer.setClearColor(0, 0);
    container.prepend(this.renderer.domElement);
    this.camera.up.set(0, 0, 1);

    const light = new three.Scene();
    const material = new three.MeshStandardMaterial({
      color: colors.bone,
      roughness: 0.78,
      side: three.DoubleSide,
    });
    this.anatomy = new three.Mesh(new three.BufferGeometry(), material);
    this.anatomy.frustumCulled = false;
    light.add(this.anatomy, ...this.lights());
    this.still = new StillPicture(light, this.camera, antialias ? 4 : 0);

    this.spring = new three.Mesh(
      new three.CylinderGeometry(1, 1, 1, 12),
      new three.MeshBasicMaterial({ color: colors.hand, transparent: true, opacity: 0.75 }),
    );
    this.spring.material.depthTest = false;
    for (let i = 0; i < mostPlanes; ++i) this.planes.push(sheet());
    this.moving.add(
      ...this.lights(),
      ...this.hand.parts,
      ...this.tool.parts,
      this.spring,
      this.trail.line,
      this.edges,
      ...this.planes,
    );
    this.moving.visible = false;

    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => {
      this.still.outdate();
      this.redraw();
    });
    new ResizeObserver(() => this.resize()).observe(container);
    this.resize();
  }

  /** Frames drawn since the beginning. */
  get frames(): number {
    return this.drawn;
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** Another anatomy: looked at from one side, as large as the view. */
  show(positions: Float32Array, corners: Uint32Array, origin: Vec3): void {
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(positions, 3));
    geometry.setIndex(new three.BufferAttribute(corners, 1));
    geometry.computeVertexNormals();
    geometry.computeBoundingBox();
    this.anatomy.geometry.dispose();
    this.anatomy.geometry = geometry;
    this.corners = corners as Uint32Array<ArrayBuffer>;
    this.origin.set(...origin);
    this.size = (geometry.boundingBox as three.Box3).getSize(new three.Vector3()).length();
    this.camera.near = 0.002 * this.size;
    this.camera.far = 10 * this.size;
    this.controls.minDistance = 0.02 * this.size;
    this.controls.maxDistance = 4 * this.size;
    this.controls.target.set(0, 0, 0);
    this.camera.position
      .set(-0.75, -0.5, 0.2)
      .normalize()
      .multiplyScalar((this.size * 1.15) / Math.min(1, 0.4 + 0.6 * this.camera.aspect));
    this.controls.update();
    this.moment = null;
    this.moving.visible = false;
    this.trail.clear();
    this.resize();
  }

  /**
   * A place for the tool to begin: beside the anatomy as it is seen, where a motion across the view
   * leads into it; nearer to it in the view, and so in sight at first.
   */
  placeBeside(distance: number): Vec3 {
    const right = new three.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const up = new three.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    const caster = new three.Raycaster();
    for (const height of [0.14, 0, 0.25, -0.14, -0.25]) {
      const from = up
        .clone()
        .multiplyScalar(height * this.size)
        .addScaledVector(right, this.size);
      caster.set(from, right.clone().negate());
      const hit = caster.intersectObject(this.anatomy)[0];
      if (hit !== undefined) return this.outside(hit.point.addScaledVector(right, distance));
    }
    return this.outside(right.multiplyScalar(0.3 * this.size));
  }

  /** Where a ray through the view meets the anatomy, led off by a distance; null where it does not. */
  placeBefore(x: number, y: number, distance: number): Vec3 | null {
    const caster = new three.Raycaster();
    caster.setFromCamera(new three.Vector2(x, y), this.camera);
    const hit = caster.intersectObject(this.anatomy)[0];
    if (!hit?.face) return null;
    const { normal } = hit.face;
    if (normal.dot(caster.ray.direction) > 0) normal.negate();
    return this.outside(hit.point.addScaledVector(normal, distance));
  }

  setToolRadius(radius: number): void {
    this.toolRadius = radius;
    this.redraw();
  }

  /** What is to be seen from now on. */
  update(moment: Moment): void {
    const { tip } = moment;
    if (this.moment?.tip.some((value, i) => value !== tip[i])) this.trail.add(this.inside(tip));
    this.moment = moment;
    this.moving.visible = true;
    this.redraw();
  }

  /** Where a place is in the view, from -1 to 1 both ways, and how deep. */
  project(place: Vec3): three.Vector3 {
    return this.inside(place).project(this.camera);
  }

  /** The place at the depth of another one, where the view is pointed at. */
  unproject(x: number, y: number, depthOf: Vec3): Vec3 {
    const depth = this.inside(depthOf).project(this.camera).z;
    return this.outside(new three.Vector3(x, y, depth).unproject(this.camera));
  }

  /** A way given in the axes of the view: to the right, up, and into it. [mm] */
  across(right: number, up: number, into: number): Vec3 {
    return new three.Vector3(right, up, -into)
      .transformDirection(this.camera.matrixWorld)
      .multiplyScalar(Math.hypot(right, up, into))
      .toArray() as Vec3;
  }

  /** Draws when the browser next does. */
  redraw(): void {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => {
      this.isDue = false;
      this.draw();
    });
  }

  private draw(): void {
    this.arrange();
    this.still.draw(this.renderer);
    this.renderer.render(this.moving, this.camera);
    ++this.drawn;
    this.onDraw();
  }

  /** Puts what moves where it is. */
  private arrange(): void {
    if (this.moment === null) return;
    const hand = this.inside(this.moment.hand);
    const tip = this.inside(this.moment.tip);
    const seen = tip.distanceTo(this.camera.position);
    const radius = Math.max(this.toolRadius, smallestBall * seen);
    this.hand.place(hand, radius);
    this.tool.place(tip, radius);

    const way = tip.clone().sub(hand);
    const length = way.length();
    this.spring.visible = length > 0.1 * radius;
    if (this.spring.visible) {
      this.spring.position.copy(hand).addScaledVector(way, 0.5);
      this.spring.quaternion.setFromUnitVectors(
        new three.Vector3(0, 1, 0),
        way.divideScalar(length),
      );
      this.spring.scale.set(0.16 * radius, length, 0.16 * radius);
    }

    const shown = this.moment.planes.slice(0, mostPlanes);
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

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.container;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.still.outdate();
    this.redraw();
  }

  private lights(): three.Light[] {
    const sky = new three.HemisphereLight("#ffffff", "#8b7f72", 1.1);
    sky.position.set(0, 0, 1);
    const key = new three.DirectionalLight("#fff6e8", 2.1);
    key.position.set(1, -1.2, 1.4);
    const rim = new three.DirectionalLight("#cfe2ff", 0.9);
    rim.position.set(-1.4, 0.8, 0.4);
    return [sky, key, rim];
  }

  /** From the frame of the mesh to that of the scene, whose origin is the middle of the anatomy. */
  private inside(place: Vec3): three.Vector3 {
    return new three.Vector3(...place).sub(this.origin);
  }

  private outside(point: three.Vector3): Vec3 {
    return point.clone().add(this.origin).toArray() as Vec3;
  }
}

/** A ball that shows through what hides it, faintly. */
class Ball {
  readonly parts: three.Mesh[];

  constructor(color: string) {
    const geometry = new three.SphereGeometry(1, 40, 24);
    const solid = new three.MeshStandardMaterial({ color, roughness: 0.35 });
    const ghost = new three.MeshBasicMaterial({
      color,
      transparent: true,
      opacity: 0.4,
      depthTest: false,
      depthWrite: false,
    });
    this.parts = [new three.Mesh(geometry, solid), new three.Mesh(geometry, ghost)];
  }

  place(at: three.Vector3, radius: number): void {
    for (const part of this.parts) {
      part.position.copy(at);
      part.scale.setScalar(radius);
    }
  }
}

/** Where a point was lately. */
class Trail {
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

/** An active plane: a disc with a rim, of radius 1. */
function sheet(): three.Group {
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
