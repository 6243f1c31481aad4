// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Plane, Vec3 } from "../engine/keepout.ts";
import { StillPicture } from "../page/still_picture.ts";
import { Ball, colors, sheet, Trail } from "./markers.ts";

/** What is seen of a moment. */
export interface Moment {
  readonly hand: Vec3;
  readonly tip: Vec3;
  readonly planes: readonly Plane[];
}

/** How many active planes are drawn at most. */
const mostPlanes = 8;
/** Where the tool may begin: how high in the view, and how near. [sizes of the anatomy] */
const placesToBegin = [0.3, 0.2, 0.1, 0].flatMap((near) =>
  [0.16, 0.08, 0.24, 0, -0.08].map((height) => [height, near] as const),
);
/** A ball that is smaller than this share of what is seen is drawn as large. */
const smallestBall = 0.006;

/** The anatomy, and in it the hand, the tool and what holds the tool back. */
export class Scene {
  readonly camera = new three.PerspectiveCamera(32, 1, 0.1, 10_000);
  private readonly renderer: three.WebGLRenderer;
  private readonly controls: OrbitControls;
  private readonly still: StillPicture;
  private readonly anatomy: three.Mesh<three.BufferGeometry, three.MeshLambertMaterial>;
  private readonly moving = new three.Scene();
  private readonly hand = new Ball(colors.hand, 0.35);
  private readonly tool = new Ball(colors.tool, 1);
  private readonly spring: three.Mesh<three.CylinderGeometry, three.MeshBasicMaterial>;
  private readonly planes: three.Group[] = [];
  private readonly edges = new three.LineSegments(
    new three.BufferGeometry(),
    new three.LineBasicMaterial({ color: colors.plane, depthTest: false, transparent: true }),
  );
  private readonly trail = new Trail(colors.tool);
  private readonly lit: three.Group[] = [];
  /** Pixels drawn for each of the screen's, along a side, at most. */
  private readonly finest: number;
  private corners = new Uint32Array();
  private origin = new three.Vector3();
  private size = 100; // of the anatomy's box: its diagonal [mm]
  private toolRadius = 1;
  private moment: Moment | null = null;
  private isDue = false;
  private drawn = 0;

  /**
   * Draws into a container, and again whenever something in it changes. `room`: the share of its
   * width that nothing covers, in the middle.
   */
  constructor(
    private readonly container: HTMLElement,
    private readonly room: () => number,
    private readonly onDraw: () => void,
  ) {
    // The still picture has smooth edges of its own.
    this.renderer = new three.WebGLRenderer({ antialias: false, alpha: true });
    // Without a graphics processor every pixel takes its time.
    const isSlow = /swiftshader|llvmpipe|software/i.test(nameOfProcessor(this.renderer));
    this.finest = isSlow ? 0.6 : 1;
    this.renderer.autoClear = false;
    this.renderer.setClearColor(0, 0);
    container.prepend(this.renderer.domElement);
    this.camera.up.set(0, 0, 1);

    const light = new three.Scene();
    const material = new three.MeshLambertMaterial({ color: colors.bone, side: three.DoubleSide });
    this.anatomy = new three.Mesh(new three.BufferGeometry(), material);
    this.anatomy.frustumCulled = false;
    light.add(this.anatomy, this.lights());
    this.still = new StillPicture(light, this.camera, isSlow ? 0 : 4);

    this.spring = new three.Mesh(
      new three.CylinderGeometry(1, 1, 1, 12),
      new three.MeshBasicMaterial({ color: colors.hand, transparent: true, opacity: 0.75 }),
    );
    this.spring.material.depthTest = false;
    for (let i = 0; i < mostPlanes; ++i) this.planes.push(sheet());
    this.moving.add(
      this.lights(),
      ...this.hand.parts,
      ...this.tool.parts,
      this.spring,
      this.trail.line,
      this.edges,
      ...this.planes,
    );
    this.moving.visible = false;

    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.renderer.domElement.addEventListener("webglcontextrestored", () => {
      this.still.outdate();
      this.redraw();
    });
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
      .set(-0.15, 0.95, 0.16)
      .normalize()
      .multiplyScalar(this.size * Math.max(1.15, 0.94 / (this.camera.aspect * this.room())));
    this.controls.update();
    this.moment = null;
    this.moving.visible = false;
    this.trail.clear();
    this.resize();
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

  /** How large the tool's ball is in the view, where it is. [px] */
  ballRadius(place: Vec3): number {
    const depth = this.inside(place).distanceTo(this.camera.position);
    const halfHeight = depth * Math.tan((0.5 * this.camera.fov * Math.PI) / 180);
    return (0.5 * this.container.clientHeight * this.toolRadius) / halfHeight;
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
    for (const lights of this.lit) lights.quaternion.copy(this.camera.quaternion);
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
    this.hand.place(hand, 1.3 * radius);
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
    this.renderer.setPixelRatio(
      Math.min(window.devicePixelRatio, 2, this.finest * window.devicePixelRatio),
    );
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.still.outdate();
    this.redraw();
  }

  /** Lights that stay with the view: from its upper left, and faintly from all sides. */
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

  /** From the frame of the mesh to that of the scene, whose origin is the middle of the anatomy. */
  private inside(place: Vec3): three.Vector3 {
    return new three.Vector3(...place).sub(this.origin);
  }

  private outside(point: three.Vector3): Vec3 {
    return point.clone().add(this.origin).toArray() as Vec3;
  }
}

/** What draws, as the browser names it. */
function nameOfProcessor(renderer: three.WebGLRenderer): string {
  const gl = renderer.getContext();
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  return String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
}
