// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import type { Counterexample, Vec3 } from "../engine/keepout.ts";
import { colorOf } from "../page/color_of.ts";
import { make } from "../page/elements.ts";
import { colors } from "./markers.ts";
import { element } from "./page.ts";
import type { FromWorker } from "./protocol.ts";

type Shown = Extract<FromWorker, { kind: "counterexamples" }>;

/**
 * The name of each counterexample, and why the rule of Li et al. (2020) fails (docs/activation.md).
 */
const words: Readonly<Record<string, readonly [title: string, why: string]>> = {
  CE2_boundary: [
    "At a rim",
    "The tip is just beside the rim of an open surface. The edge that it is nearest to has no " +
      "neighbor, so none of the conditions of Li et al. holds. Their rule adds no plane, and the motion goes through.",
  ],
  CE5_closed_octahedron: [
    "In a closed solid",
    "The nearest point of the triangle ahead lies on a ridge. Li et al.’s rule leaves the triangle to its " +
      "neighbor there. The neighbor’s plane does not cover it: the tool ends inside.",
  ],
  CE6c_larger_saddle: [
    "Over a saddle",
    "The commanded motion is free, and the certified rule returns it unchanged. Li et al.’s rule adds the " +
      "plane of a triangle that is not in the way. The motion along that plane meets another triangle.",
  ],
};

/** Duration of the motion, and of the rest after it. [ms] */
const way = 1600;
const rest = 1400;

/**
 * The dialog that plays counterexamples side by side: on the left under the rule of Li et al.
 * (2020), on the right under the certified rule.
 */
export class CounterexampleView {
  private readonly dialog = element("failures", HTMLDialogElement);
  private readonly duel = element("duel", HTMLElement);
  private readonly figures = [...this.duel.querySelectorAll("figure")];
  private renderer: three.WebGLRenderer | null = null;
  private stages: Stage[] = [];
  private shown: Shown["examples"] = [];
  private margin = 0;
  private begun = 0;

  /** Opens the dialog, at first with the first counterexample. */
  open({ examples, margin }: Shown): void {
    if (this.dialog.open) return;
    this.shown = examples;
    this.margin = margin;
    this.dialog.showModal();
    if (this.renderer === null) {
      this.renderer = new three.WebGLRenderer({ antialias: true, alpha: true });
      this.duel.prepend(this.renderer.domElement);
    }
    element("examples", HTMLElement).replaceChildren(
      ...examples.map(({ example }, i) => {
        const title = words[example.name]?.[0] ?? example.name;
        const button = make("button", { type: "button" }, title);
        button.onclick = () => this.choose(i);
        return button;
      }),
    );
    this.choose(0);
    requestAnimationFrame(() => this.play());
  }

  private choose(number: number): void {
    const chosen = this.shown[number];
    if (chosen === undefined) return;
    const buttons = element("examples", HTMLElement).querySelectorAll("button");
    for (const [i, button] of buttons.entries()) {
      button.setAttribute("aria-pressed", String(i === number));
    }
    const tools = ["--rule-paper", "--rule-certified"].map(colorOf);
    this.stages = chosen.ends.map((end, i) => new Stage(chosen.example, end, tools[i] as string));
    this.stages.forEach((stage, i) => {
      const caption = this.figures[i]?.querySelector("span");
      if (!caption) return;
      caption.className = stage.goesThrough ? "bad" : "good";
      caption.textContent = stage.goesThrough ? "goes through the surface" : "stays out";
    });
    element("why", HTMLElement).textContent =
      `${words[chosen.example.name]?.[1] ?? ""} The margin is ${this.margin}, and ` +
      `the commanded motion is ${Math.hypot(...chosen.example.desired).toFixed(2)} long.`;
    this.begun = performance.now();
  }

  private play(): void {
    const { renderer } = this;
    if (!this.dialog.open || renderer === null) return;
    const now = performance.now() - this.begun;
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const share = isStill ? 1 : Math.min((now % (way + rest)) / way, 1);
    const box = this.duel.getBoundingClientRect();
    renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    renderer.setSize(box.width, box.height);
    renderer.setScissorTest(true);
    this.stages.forEach((stage, i) => {
      const figure = this.figures[i];
      if (figure === undefined) return;
      const { left, bottom, width, height } = figure.getBoundingClientRect();
      const area = [left - box.left, box.bottom - bottom, width, height] as const;
      renderer.setViewport(...area);
      renderer.setScissor(...area);
      stage.arrange(share * share * (3 - 2 * share), isStill ? 0 : now / 1000, width / height);
      renderer.render(stage.scene, stage.camera);
    });
    requestAnimationFrame(() => this.play());
  }
}

/** One counterexample under one rule. */
class Stage {
  readonly scene = new three.Scene();
  readonly camera = new three.PerspectiveCamera(30, 1, 0.01, 1000);
  /** True if the motion of the tip crosses a triangle. */
  readonly goesThrough: boolean;
  private readonly tip: three.Mesh;
  private readonly begin: three.Vector3;
  private readonly end: three.Vector3;
  private readonly reach: number;

  constructor(example: Counterexample, end: Vec3, tool: string) {
    this.begin = vector(example.tip);
    this.end = vector(end);
    const wanted = this.begin.clone().add(vector(example.desired));
    // The motion fills the view; the mesh may be larger.
    this.reach = this.begin.distanceTo(wanted);

    const geometry = new three.BufferGeometry().setFromPoints(example.vertices.map(vector));
    geometry.setIndex(example.triangles.flat());
    const flat = geometry.toNonIndexed();
    flat.computeVertexNormals();
    const bone = new three.Mesh(
      flat,
      new three.MeshStandardMaterial({
        color: colors.bone,
        roughness: 0.8,
        side: three.DoubleSide,
        transparent: true,
        opacity: 0.82,
      }),
    );
    const rims = new three.LineSegments(
      new three.WireframeGeometry(flat),
      new three.LineBasicMaterial({ color: "#7d6f5c" }),
    );

    const ball = this.reach * 0.035;
    this.tip = new three.Mesh(
      new three.SphereGeometry(ball, 32, 16),
      new three.MeshStandardMaterial({ color: tool, roughness: 0.35 }),
    );
    const asked = new three.Line(
      new three.BufferGeometry().setFromPoints([this.begin, wanted]),
      new three.LineDashedMaterial({ color: colors.hand, dashSize: ball, gapSize: ball * 0.7 }),
    );
    asked.computeLineDistances();
    const gone = new three.Line(
      new three.BufferGeometry().setFromPoints([this.begin, this.end]),
      new three.LineBasicMaterial({ color: tool }),
    );
    for (const line of [asked, gone]) {
      line.material.depthTest = false;
      line.renderOrder = 1;
    }
    const key = new three.DirectionalLight("#ffffff", 2.2);
    key.position.set(2, -1, 3);
    this.scene.add(bone, rims, this.tip, asked, gone, key, new three.AmbientLight("#ffffff", 1.3));

    const way = this.end.clone().sub(this.begin);
    const caster = new three.Raycaster(this.begin, way.clone().normalize(), 0, way.length());
    const crossings = caster.intersectObject(bone);
    this.goesThrough = crossings.length > 0;
    for (const { point } of crossings) {
      const mark = new three.Mesh(
        new three.SphereGeometry(ball * 0.7, 24, 12),
        new three.MeshBasicMaterial({ color: colors.hand, depthTest: false, transparent: true }),
      );
      mark.position.copy(point);
      mark.renderOrder = 2;
      this.scene.add(mark);
    }
  }

  /** Shows the motion at the fraction `share`. The view turns with the seconds. */
  arrange(share: number, seconds: number, aspect: number): void {
    this.tip.position.lerpVectors(this.begin, this.end, share);
    const middle = this.begin.clone().lerp(this.end, 0.7);
    const turn = 0.5 * Math.sin(0.4 * seconds) + 0.6;
    const side = this.end
      .clone()
      .sub(this.begin)
      .cross(new three.Vector3(0.2, 0.3, 1))
      .normalize();
    const eye = side.applyAxisAngle(new three.Vector3(0, 0, 1), turn).setZ(0.45);
    this.camera.up.set(0, 0, 1);
    this.camera.position.copy(middle).addScaledVector(eye, this.reach * 2.6);
    this.camera.aspect = aspect;
    this.camera.lookAt(middle);
    this.camera.updateProjectionMatrix();
  }
}

function vector(place: Vec3): three.Vector3 {
  return new three.Vector3(...place);
}
