// SPDX-License-Identifier: BSD-3-Clause
import type { ViewMotion } from "./view_motion.ts";

/** The turn of the view by a key, without and with Shift [rad], and the factor of a zoom. */
const step = { usual: 0.1, slow: 0.02 } as const;
const zoom = 1.15;

/** The turn of each key: of the camera around the vertical, and up. */
const turns: Readonly<Record<string, readonly [number, number]>> = {
  j: [-1, 0],
  l: [1, 0],
  i: [0, 1],
  k: [0, -1],
};
const zooms: Readonly<Record<string, number>> = { "+": zoom, "=": zoom, "-": 1 / zoom };

/** Turns and zooms the view by keys, while it has the focus. */
export function addViewKeys(view: HTMLElement, motion: ViewMotion): void {
  view.addEventListener("keydown", (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const turn = turns[event.key.toLowerCase()];
    const factor = zooms[event.key];
    if (turn === undefined && factor === undefined) return;
    event.preventDefault();
    const angle = event.shiftKey ? step.slow : step.usual;
    if (turn !== undefined) motion.turn(angle * turn[0], angle * turn[1]);
    if (factor !== undefined) motion.zoom(factor);
  });
}
