// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { Capsule } from "../page/capsule.ts";
import { colors, Spring, Trail } from "./markers.ts";
import type { State } from "./protocol.ts";

/** The ball of a tip in a pane of its own, with its hand, its trail, and the last place where it crossed the surface. */
export class SecondTool {
  readonly scene = new three.Scene();
  state: State | null = null;
  private readonly wanted = new Capsule(0.35);
  private readonly ball = new Capsule();
  private readonly spring = new Spring();
  private readonly trail = new Trail();
  private readonly mark = crossingMark();

  constructor() {
    this.wanted.paint(colors.hand);
    this.spring.line.renderOrder = 1;
    this.scene.add(this.spring.line, this.trail.line, this.mark);
    this.scene.add(...this.wanted.parts, ...this.ball.parts);
  }

  paint(color: string): void {
    this.ball.paint(color);
    this.trail.paint(color);
  }

  /** Shows this state from now on. `tip`: the tool in the frame of the scene. */
  update(state: State, tip: three.Vector3): void {
    // Placed again: the old trail does not belong to it.
    if (state.placed !== this.state?.placed) this.trail.clear();
    if (this.state?.flange.place.join() !== state.flange.place.join()) this.trail.add(tip);
    this.state = state;
  }

  /** Shows no tool until the next update. */
  clear(): void {
    this.state = null;
    this.trail.clear();
  }

  /** Positions the parts. `radius`: of the ball as it is drawn. */
  arrange(tip: three.Vector3, hand: three.Vector3, radius: number, crossed: three.Vector3 | null) {
    this.scene.visible = this.state !== null;
    this.ball.place(tip, tip, radius);
    this.wanted.place(hand, hand, 1.3 * radius);
    this.spring.stretch(hand, tip, 0.16 * radius, 0.1 * radius);
    this.mark.visible = crossed !== null;
    if (crossed !== null) this.mark.position.copy(crossed);
    this.mark.scale.setScalar(0.55 * radius);
  }
}

/** Returns a red ball that marks where a motion went through a surface; visible through it. */
function crossingMark(): three.Mesh {
  const mark = new three.Mesh(
    new three.SphereGeometry(1, 24, 12),
    new three.MeshBasicMaterial({ color: colors.hand, depthTest: false, transparent: true }),
  );
  mark.renderOrder = 4;
  return mark;
}
