// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Counterexample, Vec3 } from "../engine/keepout.ts";
import { Capsule } from "../page/capsule.ts";
import { colorOf } from "../page/color_of.ts";
import { NearTriangles } from "../page/nearest.ts";
import { type Contact, Magnifier } from "./magnifier.ts";
import { colors } from "./markers.ts";
import { set } from "./page.ts";
import { Panes } from "./panes.ts";
import type { FromWorker } from "./protocol.ts";
import type { SideHead } from "./side_head.ts";
import { crossing, type Triangles } from "./wall.ts";

type Shown = Extract<FromWorker, { kind: "counterexamples" }>;
type End = Shown["examples"][number]["ends"][number];

/** Why the rule of Li et al. (2020) fails on each counterexample (docs/activation.md). */
const reasons: Readonly<Record<string, string>> = {
  CE2_boundary: "Beside the rim, Li et al.’s rule adds no plane, and the tool goes through.",
  CE5_closed_octahedron:
    "Li et al.’s rule adds no plane for the triangle ahead, and the tool ends inside the solid.",
  CE6c_larger_saddle:
    "The hand’s motion is free, but a plane of Li et al.’s rule turns the tool into the surface.",
};
/** The colors of a triangle on its two sides, and of its edges; the forbidden side is that of the section. */
const look = { free: colors.bone, section: [0.55, 0.19, 0.17], edge: [0.2, 0.09, 0.05] } as const;

/** The variables of the page's style with the colors of both tools. */
const tools = ["--rule-paper", "--rule-certified"] as const;
/** The height of the view by the length of the motion that the hand asks for; the radius of a ball by that height. */
const [shown, ball] = [1.7, 0.018];

/** Duration of the motion, and of the rest after it. [ms] */
const way = 2000;
const rest = 4000;

/**
 * Plays counterexamples in the two panes of a container: in the first one under the rule of Li et al. (2020), in the
 * second one under the certified rule. One camera sees both; a drag turns it. At the end, a section through each tool
 * shows on which side of the surface it is, in both panes with the same magnification.
 */
export class CounterexampleView {
  isOpen = false;
  private readonly panes: Panes;
  private readonly camera = new three.PerspectiveCamera(30, 1, 0.01, 1000);
  private readonly magnifiers = tools.map((tool) => new Magnifier(tool));
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
    this.magnifiers.forEach((magnifier, i) => {
      magnifier.show(look, 0);
      container.querySelectorAll(".side")[i]?.append(magnifier.element);
    });
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
    for (const { element } of this.magnifiers) element.hidden = true;
  }

  pause(isPaused: boolean): void {
    this.isPaused = isPaused;
  }

  /** Shows the counterexample of this name. */
  choose(name: string): void {
    const trial = this.shown?.examples.find(({ example }) => example.name === name);
    if (trial === undefined || this.shown === null) return;
    const { example, ends } = trial;
    const gap = Math.max(...ends.map(({ clearance }) => Math.abs(clearance)));
    this.stages = ends.map((end, i) => new Stage(example, end, colorOf(tools[i] as string), gap));
    const asked = Math.hypot(...example.desired).toFixed(2);
    set(
      "sides-words",
      `${reasons[name] ?? ""} The hand asks for ${asked} mm (dashed), and Certified keeps ` +
        `the margin of ${this.shown.margin} mm. Red in the section is the forbidden side.`,
    );
    this.aim(example);
    this.clock = { at: performance.now(), played: 0 };
  }

  /** Looks at the motion that the hand asks for from a side, with the free side above. */
  private aim({ tip, desired }: Counterexample): void {
    const [first, second] = this.stages as [Stage, Stage];
    const { camera } = this;
    const asked = vector(desired);
    const target = vector(tip).addScaledVector(asked, 0.5);
    const { normal } = first.contact;
    camera.up.copy(normal);
    const side = asked.clone().cross(normal).normalize();
    const height = shown * asked.length();
    const from = (sign: number) =>
      side
        .clone()
        .multiplyScalar(sign)
        .addScaledVector(normal, 0.4)
        .setLength(2 * height)
        .add(target);
    // From the side at which no triangle hides the tool of the certified rule.
    camera.position.copy(from([1, -1].find((sign) => !second.isHiddenFrom(from(sign))) ?? 1));
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
    const { controls, isOpen } = this;
    if (!isOpen || controls === null) return;
    const renderer = this.prepare();
    const now = performance.now();
    if (!this.isPaused) this.clock.played += now - this.clock.at;
    this.clock.at = now;
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const played = isStill ? way : this.clock.played % (way + rest);
    const share = three.MathUtils.smoothstep(played, 0, way);
    const { clientWidth, clientHeight } = this.container;
    renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    renderer.setSize(clientWidth, clientHeight);
    this.panes.areas().forEach(({ x, y, width, height }, i) => {
      const area = [x, clientHeight - y - height, width, height] as const;
      renderer.setViewport(...area);
      renderer.setScissor(...area);
      const [stage, magnifier] = [this.stages[i], this.magnifiers[i]];
      if (stage === undefined || magnifier === undefined) return;
      // Beside the section, and below the head.
      this.camera.setViewOffset(width, height, -0.12 * width, -0.05 * height, width, height);
      stage.arrange(share, this.heads[i]);
      renderer.render(stage.scene, this.camera);
      magnifier.element.hidden = share < 1;
      if (share < 1) return;
      const { contact, near } = stage;
      const pixel =
        (2 * controls.getDistance() * Math.tan((0.5 * this.camera.fov * Math.PI) / 180)) / height;
      magnifier.draw(contact, near, this.camera, pixel);
    });
    requestAnimationFrame(() => this.play());
  }
}

/** One counterexample under one rule. */
class Stage {
  readonly scene = new three.Scene();
  readonly near: NearTriangles;
  /** The end of the motion beside the surface; its clearance is below 0 if the motion went through. */
  readonly contact: Contact;
  private readonly surface: Triangles;
  private readonly tip = new Capsule();
  private readonly radius: number;

  /** `gap`: the largest clearance that the section shows. [mm] */
  constructor(
    { tip, desired, vertices, triangles }: Counterexample,
    { place, clearance }: End,
    tool: string,
    gap: number,
    private readonly begin = vector(tip),
  ) {
    const [end, wanted] = [vector(place), begin.clone().add(vector(desired))];
    this.surface = { vertices: vertices.flat(), corners: triangles.flat() };
    const positions = Float32Array.from(this.surface.vertices);
    const corners = Uint32Array.from(this.surface.corners);
    this.near = new NearTriangles(positions, corners);
    const sign = crossing(this.surface, tip, place) === null ? 1 : -1;
    const point = this.near.nearest(end)?.point ?? end;
    this.contact = {
      point,
      normal: end.clone().sub(point).multiplyScalar(sign).normalize(),
      body: { from: end, to: end, radius: 0.08 * gap },
      clearance: sign * Math.abs(clearance),
      margin: 0,
      isGuarded: false,
      isHeld: false,
      widest: gap,
    };

    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(positions, 3));
    geometry.setIndex(new three.BufferAttribute(corners, 1));
    for (const [color, side] of [
      [new three.Color(look.free), three.FrontSide],
      [new three.Color().setRGB(...look.section), three.BackSide],
    ] as const) {
      const material = new three.MeshBasicMaterial({ color, side });
      this.scene.add(new three.Mesh(geometry, material));
    }
    const rims = new three.LineBasicMaterial({ color: new three.Color().setRGB(...look.edge) });
    this.scene.add(new three.LineSegments(new three.WireframeGeometry(geometry), rims));

    const dashSize = 0.02 * begin.distanceTo(wanted);
    const dash = { dashSize, gapSize: 0.7 * dashSize };
    this.addLine(wanted, new three.LineDashedMaterial({ color: colors.hand, ...dash }));
    this.addLine(end, new three.LineBasicMaterial({ color: tool }));
    this.radius = ball * shown * begin.distanceTo(wanted);
    this.tip.paint(tool);
    this.scene.add(...this.tip.parts);
  }

  /** True if a triangle hides the end of the motion from a place. */
  isHiddenFrom(place: three.Vector3): boolean {
    return crossing(this.surface, place.toArray(), this.contact.body.to.toArray()) !== null;
  }

  /** Shows the motion at the fraction `share`; the head has the result at the end. */
  arrange(share: number, head: SideHead | undefined): void {
    const { body, clearance } = this.contact;
    const place = this.begin.clone().lerp(body.to, share);
    this.tip.place(place, place, this.radius);
    const isIn = clearance < 0;
    if (share < 1) head?.show("moving", "unguarded", Number.NaN);
    else if (isIn) head?.show("goes through the surface", "stopped", clearance, true, 3);
    else head?.show("stays out", "free", clearance, false, 3);
  }

  /** Draws a line from the begin of the motion, faintly where a triangle hides it. */
  private addLine(
    to: three.Vector3,
    material: three.LineBasicMaterial | three.LineDashedMaterial,
  ): void {
    const geometry = new three.BufferGeometry().setFromPoints([this.begin, to]);
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
