// SPDX-License-Identifier: BSD-3-Clause
import { Quaternion, Vector3 } from "three";
import { type Frame, unturned, type Vec3 } from "../engine/keepout.ts";
import type { Scene } from "./scene.ts";
import { TwoFingers } from "./two_fingers.ts";

/** The distance from the ball within which a pointer grabs the hand. [px] */
const reach = { mouse: 30, touch: 52 } as const;
/** The speed of the hand with arrow keys, without and with Shift. [mm/s] */
const keySpeed = { usual: 40, slow: 8 } as const;
/** The motion of the hand into the view per pixel of the wheel. [mm] */
const wheelDepth = 0.02;

/** The direction of each key: right, up, and into the view. */
const ways: Readonly<Record<string, Vec3>> = {
  ArrowRight: [1, 0, 0],
  ArrowLeft: [-1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

/**
 * The rotation of the hand: by keys in a second, and by a pixel of the wheel or of a second finger.
 * [rad]
 */
const turnSpeed = { usual: 1, slow: 0.2 } as const;
const pixelTurn = 0.004;

/** The axis of each key, in the view: right, up, and into it. */
const turns: Readonly<Record<string, Vec3>> = {
  w: [-1, 0, 0],
  s: [1, 0, 0],
  a: [0, -1, 0],
  d: [0, 1, 0],
  q: [0, 0, -1],
  e: [0, 0, 1],
};

/**
 * Moves the hand by mouse, touch or keys. A pointer that grabs the hand moves it across the view at
 * constant depth, within the open part of the view, and the wheel moves it deeper. Elsewhere a pointer turns the view.
 * A second finger zooms and turns the view about the hand, which stays held. A released hand follows the tool; keys
 * hold it until Escape, or until another element has the focus. If the hand can be rotated, letters, Shift and the
 * wheel, or a second finger rotate it.
 */
export class HandInput {
  private hand: Frame = { place: [0, 0, 0], turn: unturned };
  private pointer: number | null = null;
  private pane = 0; // in which the pointer has grabbed the hand
  private grip: { dx: number; dy: number } = { dx: 0, dy: 0 };
  private finger = { x: 0, y: 0 }; // position of a second one [px]
  private readonly fingers = new TwoFingers();
  private isHeld = false;
  private readonly keys = new Set<string>();
  private isSlow = false;
  private keyClock = 0;

  /**
   * `canTurn`: true if the hand can be rotated. `hold`: called with the hand, or null when it is
   * released.
   */
  constructor(
    private readonly scene: Scene,
    private readonly view: HTMLElement,
    private readonly canTurn: boolean,
    private readonly hold: (hand: Frame | null) => void,
  ) {
    // These listeners must run before those of the camera.
    const options = { capture: true, passive: false };
    view.addEventListener("pointerdown", (event) => this.take(event), options);
    view.addEventListener("pointermove", (event) => this.lead(event), options);
    view.addEventListener("pointerup", (event) => this.letGo(event), options);
    view.addEventListener("pointercancel", (event) => this.letGo(event), options);
    view.addEventListener("wheel", (event) => this.deepen(event), options);
    view.addEventListener("keydown", (event) => this.press(event));
    view.addEventListener("keyup", (event) => {
      this.isSlow = event.shiftKey;
      this.keys.delete(keyOf(event));
    });
    view.addEventListener("blur", () => {
      this.keys.clear();
      if (this.isHeld && this.pointer === null) this.release();
    });
  }

  /** Sets the position of the hand while no input moves it. */
  rest(hand: Frame): void {
    if (!this.isHeld) this.hand = hand;
  }

  /** Releases the hand from any input. */
  drop(): void {
    this.view.classList.remove("dragging");
    this.pointer = null;
    this.keys.clear();
    this.isHeld = false;
  }

  private take(event: PointerEvent): void {
    this.fingers.move(event);
    if (this.pointer !== null) {
      event.stopPropagation();
      this.finger = { x: event.clientX, y: event.clientY };
      return;
    }
    const isSecond = event.pointerType === "touch" && this.fingers.count > 1;
    if (event.button !== 0 || isSecond) return;
    const pane = this.scene.panes.under(event);
    const { place } = this.hand;
    const { dx, dy } = this.offset(event, pane);
    const { width, height } = this.scene.panes.area();
    const pixels = Math.hypot(dx * 0.5 * width, dy * 0.5 * height);
    const near = event.pointerType === "mouse" ? reach.mouse : reach.touch;
    if (pixels > Math.max(near, this.scene.ballRadius(place))) return;
    event.stopPropagation();
    event.preventDefault();
    this.view.focus({ preventScroll: true, focusVisible: false } as FocusOptions);
    this.view.setPointerCapture(event.pointerId);
    this.view.classList.add("dragging");
    this.pointer = event.pointerId;
    this.pane = pane;
    this.grip = { dx, dy };
    this.go({});
  }

  private lead(event: PointerEvent): void {
    const pinch = this.fingers.move(event);
    if (this.pointer === null) {
      // The controls of the camera zoom and shift.
      if (pinch !== null) this.scene.motion.turn(pinch.twist, 0);
      return;
    }
    event.stopPropagation();
    if (pinch !== null && !this.canTurn) {
      this.scene.pinch(this.hand.place, pinch);
      if (event.pointerId === this.pointer) this.grip = this.offset(event, this.pane);
      return;
    }
    if (event.pointerId !== this.pointer) {
      const { x, y } = this.finger;
      this.finger = { x: event.clientX, y: event.clientY };
      this.turnBy([pixelTurn * (event.clientY - y), pixelTurn * (event.clientX - x), 0]);
      return;
    }
    const at = this.inView(event, this.pane);
    const { dx, dy } = this.grip;
    this.go({ place: this.scene.unproject(at.x + dx, at.y + dy, this.hand.place) });
  }

  /** Returns the way from a pointer to the hand, in the view. */
  private offset(event: PointerEvent, pane: number): { dx: number; dy: number } {
    const at = this.inView(event, pane);
    const hand = this.scene.project(this.hand.place);
    return { dx: hand.x - at.x, dy: hand.y - at.y };
  }

  private letGo(event: PointerEvent): void {
    this.fingers.lift(event);
    if (event.pointerId !== this.pointer) return;
    event.stopPropagation();
    this.release();
  }

  private release(): void {
    this.drop();
    this.hold(null);
  }

  private deepen(event: WheelEvent): void {
    if (this.pointer === null) return;
    event.stopPropagation();
    event.preventDefault();
    // With Shift, some browsers report a horizontal wheel.
    const pixels = event.deltaY || event.deltaX;
    if (event.shiftKey && this.canTurn) this.turnBy([0, 0, pixelTurn * pixels]);
    else this.move([0, 0, -wheelDepth * pixels]);
  }

  private press(event: KeyboardEvent): void {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    this.isSlow = event.shiftKey;
    if (event.key === "Escape") this.release();
    const key = keyOf(event);
    if (ways[key] === undefined && (turns[key] === undefined || !this.canTurn)) return;
    event.preventDefault();
    if (this.keys.size === 0) {
      this.keyClock = performance.now();
      requestAnimationFrame(() => this.leadByKeys());
    }
    this.keys.add(key);
  }

  private leadByKeys(): void {
    const now = performance.now();
    // Avoids a jump after a slow frame.
    const seconds = Math.min(now - this.keyClock, 200) / 1000;
    this.keyClock = now;
    if (this.keys.size === 0) return;
    const speed = this.isSlow ? "slow" : "usual";
    const sum = (table: typeof ways, length: number) =>
      [0, 1, 2].map((axis) =>
        [...this.keys].reduce((all, key) => all + length * (table[key]?.[axis] ?? 0), 0),
      ) as unknown as Vec3;
    this.move(sum(ways, seconds * keySpeed[speed]));
    this.turnBy(sum(turns, seconds * turnSpeed[speed]));
    requestAnimationFrame(() => this.leadByKeys());
  }

  private move(way: Vec3): void {
    const across = this.scene.across(...way);
    const place = this.hand.place.map((value, i) => value + (across[i] as number));
    this.go({ place: place as unknown as Vec3 });
  }

  /** Rotates the hand by angles about the axes of the view. [rad] */
  private turnBy(angles: Vec3): void {
    if (!this.canTurn || angles.every((angle) => angle === 0)) return;
    const about = new Vector3(...this.scene.across(...angles));
    const angle = about.length();
    const turn = new Quaternion().setFromAxisAngle(about.divideScalar(angle), angle);
    turn.multiply(new Quaternion(...this.hand.turn));
    this.go({ turn: turn.toArray() as Frame["turn"] });
  }

  /** Moves the hand, but not to where cards cover it or out of the view. */
  private go(part: Partial<Frame>): void {
    const wanted = { ...this.hand, ...part };
    this.hand = { ...wanted, place: this.scene.inOpenView(wanted.place, this.hand.place) };
    this.isHeld = true;
    this.hold(this.hand);
  }

  /** Returns a position in a pane of the view, from -1 to 1 in both directions. */
  inView(event: MouseEvent, pane = this.scene.panes.under(event)): { x: number; y: number } {
    return this.scene.panes.within(event, pane);
  }
}

/** Returns the pressed key; letters as without Shift. */
const keyOf = ({ key }: KeyboardEvent): string => (key.length === 1 ? key.toLowerCase() : key);
