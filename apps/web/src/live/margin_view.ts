// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { capsuleVertices, unitCapsule } from "../page/capsule.ts";
import type { CenteredSurface } from "../page/centered_surface.ts";
import { make } from "../page/elements.ts";
import { NearTriangles } from "../page/nearest.ts";
import type { Tissue } from "../page/tissue.ts";
import type { ToolBody } from "../page/tool_shade.ts";
import { type Contact, Magnifier } from "./magnifier.ts";
import { colors, sheet } from "./markers.ts";
import { besideCards, millimetres, roomBetweenCards, set } from "./page.ts";

/** The tool beside the surface, as far as the margin needs it. */
export interface NearTool {
  readonly bodies: readonly ToolBody[];
  /** The names of the bodies; none for a tip. */
  readonly names: readonly string[];
  /** The engine's clearance of each body. [mm] */
  readonly clearances: readonly number[];
  readonly margin: number;
  readonly isGuarded: boolean;
  /** True if the surface limits the motion. */
  readonly isHeld: boolean;
}

/** Returns the clearance below which the margin is shown. [mm] */
export const shownWithin = (size: number): number => Math.min(8, 0.05 * size);

/** Returns the range of the clearance that has a color. [mm] */
export const coloredWithin = (size: number): number =>
  size >= 100 ? 5 : Number((0.05 * size).toPrecision(1));

/**
 * Makes the margin visible while the tool is near the surface. It draws a translucent shell around
 * the tool, the nearest point of the surface with its tangent plane, the clearance in words, and the
 * magnifier. Figures are those of the engine; only the place of the contact is computed here.
 */
export class MarginView {
  /** The parts that belong to the scene. */
  readonly group = new three.Group();
  private readonly shell = new three.Mesh(unitCapsule, shellMaterial());
  private readonly plane = sheet("#ffffff");
  private readonly ring = new three.Mesh(
    new three.RingGeometry(0.55, 1, 32),
    new three.MeshBasicMaterial({ color: "#ffffff", depthTest: false, transparent: true }),
  );
  private readonly callout = make("p", { class: "callout" });
  private readonly leader = make("i", { class: "leader" });
  private readonly magnifier = new Magnifier();
  private near: NearTriangles | null = null;
  private within = 1;
  private readonly normal = new three.Vector3(0, 0, 1);

  /** `container`: the view, over which callout and magnifier are placed. */
  constructor(private readonly container: HTMLElement) {
    this.shell.frustumCulled = false;
    this.shell.renderOrder = 4;
    this.ring.renderOrder = 3;
    this.group.add(this.shell, this.plane, this.ring);
    this.callout.ariaHidden = "true";
    container.append(this.leader, this.callout, this.magnifier.element);
    this.hide();
  }

  /** Takes another surface. */
  show({ positions, corners, size }: CenteredSurface, tissue: Tissue): void {
    this.near = new NearTriangles(positions, corners);
    this.within = shownWithin(size);
    this.magnifier.show(tissue, coloredWithin(size));
    this.hide();
  }

  /** Returns the point of the surface that is nearest to another point; that point itself without a surface. */
  nearestTo(point: three.Vector3): three.Vector3 {
    return this.near?.nearest(point)?.point ?? point.clone();
  }

  /** Takes the color of the tool. */
  paint(color: string): void {
    this.shell.material.uniforms.color?.value.set(color);
    this.magnifier.paint();
  }

  hide(): void {
    this.group.visible = false;
    this.callout.hidden = this.leader.hidden = this.magnifier.element.hidden = true;
  }

  /** Shows the margin of a tool if it is near the surface. `drawn`: the drawn radius of its body. */
  update(tool: NearTool, camera: three.PerspectiveCamera, drawn: readonly number[]): void {
    const least = Math.min(...tool.clearances);
    const number = tool.clearances.indexOf(least);
    const body = tool.bodies[number];
    if (this.near === null || body === undefined || !(least < this.within)) {
      this.hide();
      return;
    }
    const contact = this.contactOf(this.near, tool, body, least);
    this.group.visible = true;
    const { point, normal } = contact;
    const seen = point.distanceTo(camera.position);
    const height = 2 * seen * Math.tan((0.5 * camera.fov * Math.PI) / 180);
    const pixel = height / this.container.clientHeight;

    // A tool that is drawn larger than it is has no shell: it would be in the surface.
    const isReal = (drawn[number] ?? 0) <= 1.01 * body.radius;
    this.shell.visible = tool.isGuarded && isReal && tool.margin > 0;
    const { from, to, radius, axes, strength } = this.shell.material.uniforms as Uniforms;
    from.value.copy(body.from);
    to.value.copy(body.to);
    radius.value = body.radius + tool.margin;
    axes.value = axesAlong(body);
    strength.value = Math.min(1, 2 - (2 * least) / this.within);

    const turn = new three.Quaternion().setFromUnitVectors(new three.Vector3(0, 0, 1), normal);
    for (const part of [this.plane, this.ring]) {
      part.position.copy(point).addScaledVector(normal, 0.3 * pixel);
      part.quaternion.copy(turn);
    }
    this.plane.scale.setScalar(Math.max(1.8 * body.radius, 26 * pixel));
    // An active plane of a tip is drawn instead.
    this.plane.visible = !tool.isHeld || tool.bodies.length > 1;
    this.ring.scale.setScalar(4.5 * pixel);
    this.ring.material.color.set(least < 0 ? colors.hand : tool.isHeld ? colors.plane : "#ffffff");
    this.label(contact, tool.names[number], camera);
    this.magnifier.draw(contact, this.near, camera, pixel);
  }

  /** Returns the contact of a body, whose clearance the engine has measured. */
  private contactOf(
    near: NearTriangles,
    tool: NearTool,
    body: ToolBody,
    clearance: number,
  ): Contact {
    const core = new three.Line3(body.from, body.to);
    const at = new three.Vector3();
    let nearest = near.nearest(body.from);
    if (body.from.distanceToSquared(body.to) > 0) {
      for (const share of [0.25, 0.5, 0.75, 1]) {
        const other = near.nearest(core.at(share, at));
        if (nearest === null || (other !== null && other.distance < nearest.distance))
          nearest = other;
      }
    }
    const point = nearest?.point ?? new three.Vector3();
    // From there to the axis and back, which comes nearer each time.
    for (let i = 0; i < 6; ++i) {
      core.closestPointToPoint(point, true, at);
      if (body.from.distanceToSquared(body.to) === 0) break;
      point.copy(near.nearest(at)?.point ?? point);
    }
    const way = at.sub(point);
    const isOutside = clearance + body.radius > 0;
    if (way.lengthSq() > 1e-12) this.normal.copy(way).normalize();
    if (!isOutside) this.normal.negate();
    const { margin, isGuarded, isHeld } = tool;
    const normal = this.normal.clone();
    return { point, normal, body, clearance, margin, isGuarded, isHeld };
  }

  /** Writes the clearance beside the contact, on the side of the tool. */
  private label(
    { point, normal, clearance }: Contact,
    body: string | undefined,
    camera: three.Camera,
  ): void {
    const { clientWidth: width, clientHeight: height } = this.container;
    const onScreen = (place: three.Vector3) => {
      const { x, y } = place.clone().project(camera);
      return [0.5 * (1 + x) * width, 0.5 * (1 - y) * height] as const;
    };
    const [x, y] = onScreen(point);
    const [nx, ny] = onScreen(point.clone().add(normal)).map((value, i) => value - (i ? y : x)) as [
      number,
      number,
    ];
    // Along the surface, but upwards in any case: below it are often hand and tool.
    const length = Math.hypot(nx, ny) || 1;
    const turn = nx > 0 ? 1 : -1;
    const rise = Math.min((-turn * nx) / length, -0.5);
    const run = (turn * ny) / length;
    const [dx, dy] = [run, rise].map((part) => part / Math.hypot(run, rise)) as [number, number];
    set(this.callout, `${body ?? "clearance"} ${millimetres(clearance)}`);
    this.callout.className = `callout${clearance < 0 ? " bad" : ""}`;
    this.callout.hidden = this.leader.hidden = false;
    // The magnifier makes way for the tool.
    const { element } = this.magnifier;
    const box = element.offsetWidth + 24;
    const open = Number.parseFloat(getComputedStyle(element).left) || 0;
    const covers = y < element.offsetHeight + 60 && x < open + box + 30;
    if (covers || x > 0.55 * width) element.classList.toggle("right", covers);
    // No card and no magnifier covers the callout.
    const half = 0.5 * this.callout.offsetWidth + 6;
    const edge = half + 0.5 * (1 - roomBetweenCards(this.container)) * width - besideCards;
    const u = Math.min(Math.max(x + 62 * dx, edge), width - edge);
    const { offsetLeft, offsetTop, offsetWidth, offsetHeight } = element;
    const isBeside = u + half < offsetLeft || u - half > offsetLeft + offsetWidth;
    const top = isBeside ? 16 : offsetTop + offsetHeight + 18;
    const v = Math.min(Math.max(y + 62 * dy, top), height - 16);
    this.callout.style.transform = `translate(${u}px, ${v}px) translate(-50%, -50%)`;
    const angle = Math.atan2(v - y, u - x);
    this.leader.style.width = `${Math.hypot(u - x, v - y)}px`;
    this.leader.style.transform = `translate(${x}px, ${y}px) rotate(${angle}rad)`;
  }
}

type Uniforms = Record<"from" | "to", { value: three.Vector3 }> &
  Record<"radius" | "strength", { value: number }> & { axes: { value: three.Matrix3 } };

function axesAlong({ from, to }: ToolBody): three.Matrix3 {
  const along = to.clone().sub(from).normalize();
  const turn = new three.Quaternion().setFromUnitVectors(new three.Vector3(0, 1, 0), along);
  return new three.Matrix3().setFromMatrix4(new three.Matrix4().makeRotationFromQuaternion(turn));
}

/** Clear in the middle and denser at its rim, as a bubble is. */
const shellMaterial = () =>
  new three.ShaderMaterial({
    transparent: true,
    depthWrite: false,
    uniforms: {
      from: { value: new three.Vector3() },
      to: { value: new three.Vector3() },
      radius: { value: 1 },
      axes: { value: new three.Matrix3() },
      color: { value: new three.Color() },
      strength: { value: 1 },
    },
    vertexShader: capsuleVertices,
    fragmentShader: `
      uniform vec3 color;
      uniform float strength;
      varying vec3 bent;
      void main() {
        float rim = 1.0 - abs(normalize(bent).z);
        gl_FragColor = vec4(color, strength * (0.14 + 0.75 * rim * rim * rim));
        #include <colorspace_fragment>
      }`,
  });
