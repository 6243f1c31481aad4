// SPDX-License-Identifier: BSD-3-Clause

/** The change between two events: how much farther apart two fingers are, and their turn, clockwise. [rad] */
export interface Pinch {
  readonly spread: number;
  readonly twist: number;
}

/** Follows the fingers on the view. */
export class TwoFingers {
  private readonly fingers = new Map<number, { x: number; y: number }>();

  /** The number of fingers on the view. */
  get count(): number {
    return this.fingers.size;
  }

  /** Adds a finger, or moves it. Returns the change if there are two. */
  move({ pointerId, pointerType, clientX, clientY }: PointerEvent): Pinch | null {
    if (pointerType !== "touch") return null;
    const before = this.between();
    this.fingers.set(pointerId, { x: clientX, y: clientY });
    const now = this.between();
    if (before === null || now === null) return null;
    const twist = Math.atan2(
      before.x * now.y - before.y * now.x,
      before.x * now.x + before.y * now.y,
    );
    return { spread: Math.hypot(now.x, now.y) / Math.hypot(before.x, before.y), twist };
  }

  lift({ pointerId }: PointerEvent): void {
    this.fingers.delete(pointerId);
  }

  /** Returns the way from one finger to the other; null unless there are two, apart from each other. */
  private between(): { x: number; y: number } | null {
    const [one, other] = [...this.fingers.values()];
    if (one === undefined || other === undefined || this.fingers.size > 2) return null;
    const way = { x: other.x - one.x, y: other.y - one.y };
    return way.x === 0 && way.y === 0 ? null : way;
  }
}
