// SPDX-License-Identifier: BSD-3-Clause
/** What lies over a picture of anatomy: balls, rings and labels at places of it, and a scale bar. */
import type * as three from "three";
import { drawn } from "../page/elements.ts";

/** Something at a place of the anatomy. */
export interface Mark {
  readonly element: SVGGElement;
  place: three.Vector3;
}

/** A circle at a place. `label`: what it is called, beside it, or with a ball below. */
export function mark(
  kind: string,
  place: three.Vector3,
  radius: number,
  label: SVGTSpanElement | null = null,
): Mark {
  const text = label ? [drawn("text", {}, drawn("tspan", {}), label)] : [];
  const circle = drawn("circle", { r: String(radius) });
  return { element: drawn("g", { class: kind }, circle, ...text), place };
}

/** Puts a mark where its place is seen; its label stays in the picture, and points the way out of it. */
export function placeMark(
  { element, place }: Mark,
  camera: three.Camera,
  width: number,
  height: number,
): void {
  const seen = place.clone().project(camera);
  const [x, y] = [((seen.x + 1) * width) / 2, ((1 - seen.y) * height) / 2];
  const [circle, text] = element.children as unknown as [SVGCircleElement, SVGTextElement?];
  circle.setAttribute("cx", x.toFixed(1));
  circle.setAttribute("cy", y.toFixed(1));
  if (!text) return;
  const arrow = y > height ? "↓ " : y < 0 ? "↑ " : x > width ? "→ " : x < 0 ? "← " : "";
  (text.firstChild as SVGTSpanElement).textContent = arrow;
  const isLeft = x > 0.55 * width;
  const isBeside = element.classList.contains("ring");
  const [dx, dy] = isBeside ? [24, 5] : [14, 28];
  const within = (value: number, low: number, high: number) =>
    Math.min(Math.max(value, low), high).toFixed(1);
  text.setAttribute("text-anchor", isLeft ? "end" : "start");
  text.setAttribute("x", within(x + (isLeft ? -dx : dx), 0.04 * width, 0.96 * width));
  text.setAttribute("y", within(y + dy, 0.08 * height, 0.84 * height));
}

/** A bar of a round length, so that a reader can tell millimetres from centimetres. */
export function scaleBar(element: SVGGElement, pixel: number, width: number, height: number): void {
  const longest = 0.24 * width * pixel;
  const power = 10 ** Math.floor(Math.log10(longest));
  const length = power * ([5, 2].find((times) => times * power <= longest) ?? 1);
  const [x, y] = [0.03 * width, 0.96 * height];
  const [bar, text] = element.children as unknown as [SVGPathElement, SVGTextElement];
  bar.setAttribute("d", `M${x},${y - 5}v10m0,-5h${length / pixel}m0,-5v10`);
  text.setAttribute("x", String(x));
  text.setAttribute("y", String(y - 12));
  const [value, unit] = length < 0.01 ? [1000 * length, "µm"] : [length, "mm"];
  text.textContent = `${Number(value.toPrecision(1))}\u00a0${unit}`;
}
