// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Counterexample, Vec3 } from "../engine/keepout.ts";
import { Capsule } from "../page/capsule.ts";
import { colorOf } from "../page/color_of.ts";
import { colors } from "./markers.ts";
import { set } from "./page.ts";
import { Panes } from "./panes.ts";
import type { FromWorker } from "./protocol.ts";
import { crossingMark } from "./second_tool.ts";
import type { SideHead } from "./side_head.ts";
import { crossing, type Triangles } from "./wall.ts";

type Shown = Extract<FromWorker, { kind: "counterexamples" }>;
type Trial = Shown["examples"][number];

/** Why the rule of Li et al. (2020) fails on each counterexample (docs/activation.md). */
const reasons: Readonly<Record<string, string>> = {
  CE2_boundary:
    "The tip is just beside the rim of an open surface. The edge that it is nearest to has no " +
    "neighbor, so none of the conditions of Li et al. holds. Their rule adds no plane, and the motion goes through. " +
    "The surface is red from behind: drag to turn the view.",
  CE5_closed_octahedron:
    "The nearest point of the triangle ahead lies on a ridge. Li et al.’s rule leaves the triangle to its " +
    "neighbor there. The neighbor’s plane does not cover it: the tool ends inside, which is red.",
  CE6c_larger_saddle:
    "The commanded motion is free, and the certified rule returns it unchanged. Li et al.’s rule adds the " +
    "plane of a triangle that is not in the way. The motion along that plane meets another triangle. The surface is red from behind.",
};
/** The colors of a counterexample's triangles on the free side and on the forbidden side. */
const faces = { free: colors.bone, forbidden: "#8f4a4e" } as const;

/** The radius of the ball, as a fraction of the length that the view shows. */
const ball = 0.03;

/** Duration of the motion, of the approach of the view to its end, and of the rest after both. [ms] */
const way = 2000;
const approach = 1200;
const rest = 2800;

/**
 * Plays counterexamples in the two panes of a container: in the first one under the rule of Li et al. (2020), in the
 * second one under the certified rule. One camera sees both; a drag turns it.
 */
export class CounterexampleView {
  isOpen = false;
  private readonly panes: Panes;
  private readonly camera = new three.PerspectiveCamera(30, 1, 0.01, 1000);
  private renderer: three.WebGLRenderer | null = null;
  private controls: OrbitControls | null = null;
  private stages: Stage[] = [];
  private shown: Shown | null = null;
  private isPaused = false;
  private clock = { at: 0, played: 0 };

  constructor(
    private readonly container: HTMLElement,
    private readonly heads: readonly SideHead[],
  ) {
    this.panes = new Panes(container);
    this.panes.count = 2;
  }

  open(shown: Shown): void {
    this.shown = shown;
    const renderer = this.prepare();
    renderer.domElement.hidden = false;
    if (!this.isOpen) requestAnimationFrame(() => this.play());
    this.isOpen = true;
  }

  close(): void {
    this.isOpen = false;
    if (this.renderer) this.renderer.domElement.hidden = true;
  }

  pause(isPaused: boolean): void {
    this.isPaused = isPaused;
  }

  /** Shows the counterexample of this name. */
  choose(name: string): void {
    const trial = this.shown?.examples.find(({ example }) => example.name === name);
    if (trial === undefined || this.shown === null) return;
    const { example, ends } = trial;
    this.stages = ends.map(({ place }, i) => {
      const color = colorOf(i === 0 ? "--rule-paper" : "--rule-certified");
      return new Stage(example, place, color);
    });
    this.stages.forEach((stage, i) => {
      const { clearance } = ends[i] as Trial["ends"][number];
      const isIn = stage.crossedAt !== null;
      const words = isIn ? "goes through the surface" : "stays out";
      this.heads[i]?.show(words, isIn ? "stopped" : "free", clearance, isIn, 3);
    });
    const asked = Math.hypot(...example.desired).toFixed(2);
    set(
      "sides-words",
      `${reasons[name] ?? ""} One step: the hand asks for ${asked} mm (dashed), the margin is ` +
        `${this.shown.margin} mm. Then the view comes close to the end. The tool is a point, in the middle of the ball, ` +
        "which is pale where the surface hides it. The red disc marks where it goes through.",
    );
    const [first] = this.stages;
    if (first !== undefined) this.aim(example, first, ends);
    this.clock = { at: performance.now(), played: 0 };
  }

  /** Looks at the place where the motion crosses a triangle, from a side, with the free side above. */
  private aim(
    { tip, desired }: Counterexample,
    { crossedAt, normal }: Stage,
    ends: Trial["ends"],
  ): void {
    const target = vector(crossedAt ?? tip);
    const { place: end } = ends[0] as Trial["ends"][number];
    const { camera } = this;
    camera.up.copy(normal);
    const side = vector(end).sub(vector(tip)).cross(normal).normalize();
    const length = Math.max(5 * vector(end).distanceTo(target), 0.35 * vector(desired).length());
    this.stages.forEach((stage, i) => {
      stage.fit(target, length, (ends[i] as Trial["ends"][number]).clearance);
    });
    const from = (sign: number) =>
      side
        .clone()
        .multiplyScalar(sign)
        .addScaledVector(normal, 0.4)
        .setLength(2 * length)
        .add(target);
    // From the side at which no triangle hides the tool of the certified rule.
    const isSeen = (sign: number) => this.stages[1]?.isHiddenFrom(from(sign)) === false;
    camera.position.copy(from([1, -1].find(isSeen) ?? 1));
    const renderer = this.prepare();
    this.controls?.dispose(); // they keep the first direction that is up
    this.controls = new OrbitControls(camera, renderer.domElement);
    this.controls.target.copy(target);
    this.controls.update();
  }

  private prepare(): three.WebGLRenderer {
    if (this.renderer === null) {
      this.renderer = new three.WebGLRenderer({ antialias: true, alpha: true });
      this.renderer.setScissorTest(true);
      this.renderer.domElement.id = "trials";
      this.container.prepend(this.renderer.domElement);
    }
    return this.renderer;
  }

  private play(): void {
    if (!this.isOpen) return;
    const renderer = this.prepare();
    const now = performance.now();
    if (!this.isPaused) this.clock.played += now - this.clock.at;
    this.clock.at = now;
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const played = isStill ? way + approach : this.clock.played % (way + approach + rest);
    const shareOf = (begin: number, duration: number) =>
      three.MathUtils.smoothstep(played, begin, begin + duration);
    const [share, nearness] = [shareOf(0, way), shareOf(way, approach)];
    const { clientWidth, clientHeight } = this.container;
    renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    renderer.setSize(clientWidth, clientHeight);
    this.panes.areas().forEach(({ x, y, width, height }, i) => {
      const area = [x, clientHeight - y - height, width, height] as const;
      renderer.setViewport(...area);
      renderer.setScissor(...area);
      const stage = this.stages[i];
      if (stage === undefined) return;
      const view = this.viewOf(stage, nearness, width / height);
      stage.arrange(share, stage.closest ** nearness, view);
      renderer.render(stage.scene, view);
    });
    requestAnimationFrame(() => this.play());
  }

  /**
   * Returns the camera of a stage. `nearness`: 0 for the camera of the controls, 1 for the last view. The last view is
   * close to the end of the motion, and along the surface. It shows a section of a closed solid.
   */
  private viewOf(stage: Stage, nearness: number, aspect: number): three.PerspectiveCamera {
    const target = this.controls?.target ?? new three.Vector3();
    const scale = stage.closest ** nearness;
    const view = this.camera.clone();
    const away = this.camera.position.clone().sub(target);
    away.addScaledVector(view.up, -0.85 * nearness * away.dot(view.up)).multiplyScalar(scale);
    const middle = target.clone().lerp(stage.last, nearness);
    view.position.copy(middle).add(away);
    view.lookAt(middle);
    view.near *= scale;
    // The section begins just before the tool.
    const cut = away.length() - 1.5 * scale * stage.radius;
    if (stage.isClosed) view.near = three.MathUtils.lerp(view.near, cut, nearness);
    view.aspect = aspect;
    view.updateProjectionMatrix();
    return view;
  }
}

/** One counterexample under one rule. */
class Stage {
  readonly scene = new three.Scene();
  /** The place where the motion of the tip crosses a triangle, or null. */
  readonly crossedAt: Vec3 | null;
  /** The normal of that triangle, into the free side. */
  readonly normal = new three.Vector3(0, 0, 1);
  /** True if each edge has a triangle on both sides. */
  readonly isClosed: boolean;
  private readonly surface: Triangles;
  private readonly tip = new Capsule();
  private readonly lights = new three.Group();
  /** The length that the view shows at last, as a fraction of that at first. */
  closest = 1;
  /** The radius of the ball at first. [mm] */
  radius = 0;
  private readonly mark = crossingMark();
  /** The fraction of the motion that precedes the view. */
  private start = 0;

  constructor(
    example: Counterexample,
    private readonly end: Vec3,
    tool: string,
    private readonly begin = example.tip,
  ) {
    const from = vector(begin);
    const wanted = from.clone().add(vector(example.desired));
    const corners = example.triangles.flat();
    const vertices = example.vertices.flat();
    this.surface = { vertices, corners };
    const edges = example.triangles.flatMap(([a, b, c]) => [
      [a, b],
      [b, c],
      [c, a],
    ]);
    const directed = new Set(edges.map(([from, to]) => `${from} ${to}`));
    this.isClosed = edges.every(([from, to]) => directed.has(`${to} ${from}`));
    this.crossedAt = crossing(this.surface, begin, end);
    const crossed = example.triangles.find((one) =>
      crossing({ vertices, corners: one }, begin, end),
    );
    if (crossed !== undefined) {
      const [a, b, c] = crossed.map((corner) => vector(example.vertices[corner] as Vec3));
      new three.Triangle(a, b, c).getNormal(this.normal);
    }

    const geometry = new three.BufferGeometry().setFromPoints(example.vertices.map(vector));
    geometry.setIndex(corners);
    const flat = geometry.toNonIndexed();
    flat.computeVertexNormals();
    // Seen from the forbidden side, a triangle has another color.
    for (const [color, side] of [
      [faces.free, three.FrontSide],
      [faces.forbidden, three.BackSide],
    ] as const) {
      this.scene.add(new three.Mesh(flat, new three.MeshLambertMaterial({ color, side })));
    }
    const rims = new three.LineBasicMaterial({ color: "#5d5142" });
    this.scene.add(new three.LineSegments(new three.WireframeGeometry(flat), rims));

    const dashSize = 0.02 * from.distanceTo(wanted);
    const dash = { dashSize, gapSize: 0.7 * dashSize };
    this.addLine(from, wanted, new three.LineDashedMaterial({ color: colors.hand, ...dash }));
    this.addLine(from, vector(end), new three.LineBasicMaterial({ color: tool }));
    this.tip.paint(tool);
    this.scene.add(...this.tip.parts);
    if (this.crossedAt !== null) {
      this.mark.position.copy(vector(this.crossedAt));
      this.scene.add(this.mark);
    }
    const key = new three.DirectionalLight("#ffffff", 1.9);
    key.position.set(-1.6, 1, 0.3);
    this.lights.add(key, new three.HemisphereLight("#ffffff", "#b5a99a", 1.6));
    this.scene.add(this.lights);
  }

  /** The end of the motion. */
  get last(): three.Vector3 {
    return vector(this.end);
  }

  /** True if a triangle hides the end of the motion from a place. */
  isHiddenFrom(place: three.Vector3): boolean {
    return crossing(this.surface, place.toArray(), this.end) !== null;
  }

  /**
   * Fits the tool to a view that shows `length` around a target, and begins the motion within it. At last the view
   * shows a ball that is smaller than the clearance of its middle.
   */
  fit(target: three.Vector3, length: number, clearance: number): void {
    this.radius = ball * length;
    this.closest = Math.min(1, (0.5 * Math.abs(clearance)) / this.radius);
    const [from, to] = [vector(this.begin), vector(this.end)];
    for (this.start = 0; this.start < 0.9; this.start += 0.02) {
      if (from.clone().lerp(to, this.start).distanceTo(target) <= 0.42 * length) return;
    }
  }

  /** Shows the motion at the fraction `share`, in a view scaled by `scale`. The lights are fixed to the view. */
  arrange(share: number, scale: number, camera: three.Camera): void {
    const fraction = this.start + share * (1 - this.start);
    const place = vector(this.begin).lerp(vector(this.end), fraction);
    this.tip.place(place, place, scale * this.radius);
    this.mark.scale.setScalar(0.6 * scale * this.radius);
    this.lights.quaternion.copy(camera.quaternion);
  }

  /** Draws a line, faintly where a triangle hides it. */
  private addLine(
    from: three.Vector3,
    to: three.Vector3,
    material: three.LineBasicMaterial | three.LineDashedMaterial,
  ): void {
    const geometry = new three.BufferGeometry().setFromPoints([from, to]);
    const hidden = material.clone();
    hidden.depthTest = false;
    hidden.transparent = true;
    hidden.opacity = 0.25;
    for (const one of [hidden, material]) {
      this.scene.add(new three.Line(geometry, one).computeLineDistances());
    }
  }
}

function vector(place: Vec3): three.Vector3 {
  return new three.Vector3(...place);
}
