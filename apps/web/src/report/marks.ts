// SPDX-License-Identifier: BSD-3-Clause
/** Marks over a picture of anatomy: balls, rings and labels at places of it, and a scale bar. */
import * as three from "three";
import { drawn } from "../page/elements.ts";
import { extremes } from "./extremes.ts";
import type { Lengths } from "./painting.ts";

/** A mark at a place of the anatomy. */
export interface Mark {
  readonly element: SVGGElement;
  readonly label: SVGTSpanElement | null;
  place: three.Vector3;
}

/** A mark and its position in a picture. [px] */
interface Spot {
  readonly mark: Mark;
  readonly x: number;
  readonly y: number;
}

/** A rectangle of a picture. [px] */
interface Box {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}

/** The width of a letter of a label, at most. [px] */
const letter = 9;

/** A circle at a place. `label`: its text, beside a ring or below a ball. */
export function mark(
  kind: string,
  place: three.Vector3,
  radius: number,
  label: SVGTSpanElement | null = null,
): Mark {
  const text = label ? [drawn("text", {}, label)] : [];
  const circle = drawn("circle", { r: String(radius) });
  return { element: drawn("g", { class: kind }, circle, ...text), label, place };
}

const circleOf = ({ element }: Mark) => element.firstElementChild as SVGCircleElement;
const has = ({ element }: Mark, kind: string) => element.classList.contains(kind);
const textOf = ({ element }: Mark) => element.lastElementChild as SVGTextElement;

/**
 * Positions the marks of a picture. Rings that are close share a label. The label of a mark outside
 * the picture points to it, but the number of a ring ("numbered") is hidden. `lengths`: the paths in
 * the picture, which labels should not cover.
 */
export function placeMarks(
  marks: readonly Mark[],
  lengths: readonly Lengths[],
  camera: three.Camera,
  width: number,
  height: number,
): void {
  const labeled: Spot[] = [];
  for (const mark of marks) {
    const seen = mark.place.clone().project(camera);
    const [x, y] = [((seen.x + 1) * width) / 2, ((1 - seen.y) * height) / 2];
    circleOf(mark).setAttribute("cx", x.toFixed(1));
    circleOf(mark).setAttribute("cy", y.toFixed(1));
    if (mark.label) labeled.push({ mark, x, y });
  }
  const picture = { left: 0, right: width, top: 0, bottom: height };
  const labels: Box[] = [];
  const rings = labeled.filter(
    ({ mark, x, y }) =>
      has(mark, "ring") && overlap(picture, { left: x, right: x, top: y, bottom: y }),
  );
  const isAlone = (spot: Spot) => !rings.includes(spot) && !has(spot.mark, "numbered");
  const paths = labeled.some(isAlone) ? placesOf(lengths, camera, width, height) : [];
  for (const spot of labeled) {
    if (rings.includes(spot)) continue;
    if (has(spot.mark, "numbered")) textOf(spot.mark).setAttribute("display", "none");
    else labels.push(placeLabel(spot, labels, paths, width, height));
  }
  labelRings(groupsOf(rings), width, height);
}

/** Returns the ends of the segments of paths in a picture. */
const placesOf = (
  lengths: readonly Lengths[],
  camera: three.Camera,
  width: number,
  height: number,
): Box[] =>
  lengths.flatMap(({ ends }) =>
    Array.from({ length: ends.length / 3 }, (_, i) => {
      const seen = new three.Vector3().fromArray(ends, 3 * i).project(camera);
      const [x, y] = [((seen.x + 1) * width) / 2, ((1 - seen.y) * height) / 2];
      return { left: x, right: x, top: y, bottom: y };
    }),
  );

/**
 * Puts the label of a mark beside it, where it covers no other label and the fewest places of paths.
 * If the mark is outside the picture, the label points to it. Returns the place of the label.
 */
function placeLabel(
  { mark, x, y }: Spot,
  labels: readonly Box[],
  paths: readonly Box[],
  width: number,
  height: number,
): Box {
  const arrow = y > height ? "↓ " : y < 0 ? "↑ " : x > width ? "→ " : x < 0 ? "← " : "";
  const within = (value: number, low: number, high: number) => Math.min(Math.max(value, low), high);
  const wide = letter * (arrow + mark.label?.textContent).length;
  const first = within(y + 28, 0.08 * height, 0.84 * height);
  const sides = x > 0.55 * width ? [true, false] : [false, true];
  const spots = [0, 1, -1, 2, -2, 3, -3].flatMap((lines) =>
    sides.map((isLeft) => {
      const at = within(x + (isLeft ? -14 : 14), 0.04 * width, 0.96 * width);
      const base = within(first + 21 * lines, 0.08 * height, 0.9 * height);
      const [left, right] = isLeft ? [at - wide, at] : [at, at + wide];
      const box = { left, right, top: base - 15, bottom: base + 4 };
      const covered = (boxes: readonly Box[]) =>
        boxes.filter((other) => overlap(other, box)).length;
      const isOut = left < 0 || right > width;
      const cost = (covered(labels) + (isOut ? 1 : 0)) * (paths.length + 1) + covered(paths);
      return { isLeft, at, base, box, cost };
    }),
  );
  const least = Math.min(...spots.map(({ cost }) => cost));
  const best = spots.find(({ cost }) => cost === least) as (typeof spots)[number];
  write([mark], best.isLeft ? "end" : "start", best.at, best.base, arrow);
  return best.box;
}

/** Writes the labels of marks at a position, separated by commas, as the text of the first. */
function write(marks: readonly Mark[], anchor: string, x: number, y: number, before = ""): void {
  for (const one of marks) textOf(one).setAttribute("display", "none");
  const text = textOf(marks[0] as Mark);
  const labels = marks.map(({ label }) => label as SVGTSpanElement);
  text.replaceChildren(
    before,
    ...labels.flatMap((label, place) => (place === 0 ? [label] : [", ", label])),
  );
  text.removeAttribute("display");
  text.setAttribute("text-anchor", anchor);
  text.setAttribute("x", x.toFixed(1));
  text.setAttribute("y", y.toFixed(1));
}

/** Returns groups of rings that are close enough to share a label, in their order. */
function groupsOf(rings: readonly Spot[]): Spot[][] {
  let groups: Spot[][] = [];
  for (const ring of rings) {
    const isNear = (group: readonly Spot[]) =>
      group.some(({ x, y }) => Math.hypot(x - ring.x, y - ring.y) < 20);
    const joined = [...groups.filter(isNear).flat(), ring];
    joined.sort((a, b) => rings.indexOf(a) - rings.indexOf(b));
    groups = [...groups.filter((group) => !isNear(group)), joined];
  }
  return groups;
}

const overlap = (a: Box, b: Box): boolean =>
  a.left <= b.right && b.left <= a.right && a.top <= b.bottom && b.top <= a.bottom;

/** Puts the label of each group on the side where it covers the fewest other marks. */
function labelRings(groups: readonly (readonly Spot[])[], width: number, height: number): void {
  const rings = groups.map(boxOf);
  const scale = { left: 0, right: 0.3 * width, top: 0.96 * height - 26, bottom: height };
  const others: Box[] = [...rings, scale];
  groups.forEach((group, number) => {
    const ring = rings[number] as Box;
    const texts = group.map(({ mark }) => mark.label?.textContent ?? "");
    const wide = letter * texts.join(", ").length;
    const [low, tall, gap] = [4, 17, 8];
    const [x, y] = [(ring.left + ring.right) / 2, (ring.top + ring.bottom) / 2];
    const right = ["start", ring.right + gap, y + 5] as const;
    const left = ["end", ring.left - gap, y + 5] as const;
    const sides = [
      ...(x > 0.55 * width ? [left, right] : [right, left]),
      ["middle", x, ring.top - gap] as const,
      ["middle", x, ring.bottom + gap + tall - low] as const,
    ].map(([anchor, at, base]) => {
      const from = at - (anchor === "start" ? 0 : anchor === "end" ? wide : wide / 2);
      const [top, bottom] = [base + low - tall, base + low];
      const box = { left: from, right: from + wide, top, bottom };
      const isOut = from < 0 || box.right > width || top < 0 || bottom > height;
      const covered = others.filter((other) => other !== ring && overlap(other, box)).length;
      return { anchor, at, base, box, cost: covered + (isOut ? groups.length + 1 : 0) };
    });
    const least = Math.min(...sides.map(({ cost }) => cost));
    const best = sides.find(({ cost }) => cost === least) as (typeof sides)[number];
    others.push(best.box);
    write(
      group.map(({ mark }) => mark),
      best.anchor,
      best.at,
      best.base,
    );
  });
}

/** Returns the bounds of the circles of rings. */
function boxOf(group: readonly Spot[]): Box {
  const [left, right] = extremes(group.map(({ x }) => x));
  const [top, bottom] = extremes(group.map(({ y }) => y));
  const radius = Number(circleOf((group[0] as Spot).mark).getAttribute("r"));
  return {
    left: left - radius,
    right: right + radius,
    top: top - radius,
    bottom: bottom + radius,
  };
}

/** Draws a bar of a round length, so that a reader can distinguish millimeters from centimeters. */
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
