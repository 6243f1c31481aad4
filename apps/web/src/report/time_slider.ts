// SPDX-License-Identifier: BSD-3-Clause
import { make } from "../page/elements.ts";
import type { AnatomyView } from "./anatomy_view.ts";
import { ordinal } from "./runs.ts";

/** The playing time of a stroke. [ms] */
const playing = 8000;

/**
 * Returns a list of strokes; `show` makes the view of the chosen one, which replaces the view
 * before.
 */
export function strokeChooser(
  options: readonly HTMLElement[],
  first: number,
  show: (stroke: number) => { dispose: () => void },
): HTMLSelectElement {
  const chooser = make("select", { "aria-label": "stroke" }, ...options);
  chooser.value = String(first);
  let view = options.length > 0 ? show(first) : null;
  chooser.addEventListener("change", () => {
    view?.dispose();
    view = show(Number(chooser.value));
  });
  return chooser;
}

/**
 * Chooses a cycle of the stroke that a view shows, and plays it in slow motion. `from`: an array
 * with one entry a cycle. Also disposes of the view.
 */
export function timeSlider(
  view: AnatomyView,
  from: string,
  cycles: number,
  follow: (cycle: number) => void,
) {
  const slider = make("input", { type: "range", min: "0", "aria-label": "time" });
  slider.max = String(cycles - 1);
  const play = make("button", { type: "button", class: "play" }, "Play");
  const cycle = make("span", { class: "cycle" });
  let frame = 0;
  const go = (to: number) => {
    slider.value = String(to);
    cycle.replaceChildren("cycle ", ordinal(`${from}/${to}`));
    follow(to);
  };
  const stop = () => {
    cancelAnimationFrame(frame);
    frame = 0;
    play.textContent = "Play";
  };
  const start = () => {
    const first = Number(slider.value) < cycles - 1 ? Number(slider.value) : 0;
    const began = performance.now();
    const next = (now: number) => {
      const to = first + Math.floor((Math.max(now - began, 0) / playing) * cycles);
      go(Math.min(to, cycles - 1));
      if (to < cycles - 1) frame = requestAnimationFrame(next);
      else stop();
    };
    play.textContent = "Pause";
    frame = requestAnimationFrame(next);
  };
  play.addEventListener("click", () => (frame === 0 ? start() : stop()));
  slider.addEventListener("input", () => {
    stop();
    go(Number(slider.value));
  });
  const dispose = () => {
    stop();
    view.dispose();
  };
  return { element: make("div", { class: "time" }, play, slider, cycle), go, dispose };
}
