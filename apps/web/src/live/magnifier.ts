// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { colorOf } from "../page/color_of.ts";
import { make } from "../page/elements.ts";
import type { NearTriangles } from "../page/nearest.ts";
import type { Tissue } from "../page/tissue.ts";
import { clearanceColors, type ToolBody } from "../page/tool_shade.ts";
import { millimetres, set } from "./page.ts";

/** The contact that the magnifier shows, in the scene. */
export interface Contact {
  /** The nearest point of the surface, and the direction from there to the tool. */
  readonly point: three.Vector3;
  readonly normal: three.Vector3;
  readonly body: ToolBody;
  /** [mm] */
  readonly clearance: number;
  readonly margin: number;
  readonly isGuarded: boolean;
  /** True if the surface limits the motion. */
  readonly isHeld: boolean;
  /** For a point beside a surface that may be open: the clearance that fills the picture, at any magnification. [mm] */
  readonly widest?: number;
}

/** The largest magnification of the view. */
const most = 10;
/** Parts of the width: the margin at most, and the clearance at most. */
const [widestMargin, widestGap] = [0.22, 0.4];
/** The distance of the lines that hatch the solid. [px] */
const hatch = 7;

/** A piece of a section: its ends, and the direction out of the solid. */
type Piece = readonly [ax: number, ay: number, bx: number, by: number, nx: number, ny: number];

/**
 * An inset that cuts surface and tool through the contact, magnified: the solid, the tool with its
 * margin, the tangent plane and the clearance. It is drawn with the triangles near the contact
 * only, without WebGL.
 */
export class Magnifier {
  readonly element: HTMLElement;
  private readonly canvas = make("canvas", {});
  private readonly times = make("span");
  private readonly kept = make("span");
  private readonly ticks = make("span", { class: "ticks" });
  private colors: Readonly<Record<string, string>> = {};
  private solid = "";
  private edge = "";
  private readonly font = `600 12px ${getComputedStyle(document.body).fontFamily}`;
  /** The text and colors of the present picture. */
  private drawn = "";

  /** `tool`: the variable of the page's style with the color of the tool. */
  constructor(private readonly tool = "--tool") {
    const legend = make("span", { class: "bands" });
    for (const color of clearanceColors) {
      const band = make("i");
      band.style.background = color;
      legend.append(band);
    }
    const caption = make("b", {}, this.times, this.kept);
    const meaning = make("span", {}, "from surface to tool");
    const words = make("figcaption", {}, caption, legend, this.ticks, meaning);
    this.element = make("figure", { class: "magnifier" }, this.canvas, words);
    this.element.hidden = true;
    this.canvas.role = "img";
    this.canvas.ariaLabel = "A section through the contact of tool and surface, magnified";
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.paint());
  }

  /** Takes the colors of the page, and those of a tissue. `range`: of the legend. [mm] */
  show(tissue: Pick<Tissue, "section" | "edge">, range: number): void {
    const css = (color: readonly [number, number, number]) =>
      `#${new three.Color().setRGB(...color).getHexString()}`;
    this.solid = css(tissue.section);
    this.edge = css(tissue.edge);
    this.ticks.replaceChildren(
      ...[0, range / 2, range].map((value) => make("span", {}, `${value}`)),
    );
    this.ticks.lastElementChild?.append(" mm");
    this.paint();
  }

  paint(): void {
    const names = ["--ink", this.tool, "--plane", "--alarm", "--solid"];
    this.drawn = "";
    this.colors = Object.fromEntries(names.map((name) => [name, colorOf(name)]));
  }

  /** Draws a contact. `pixel`: the size of a pixel of the view there. [mm] */
  draw(contact: Contact, near: NearTriangles, camera: three.Camera, pixel: number): void {
    this.element.hidden = false;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const { point, normal, clearance, margin, isHeld, isGuarded, widest } = contact;
    const view = [camera.matrixWorld.elements, point.toArray(), normal.toArray(), pixel];
    const now = [view, clearance, margin, isHeld, isGuarded, width, height].join();
    if (width === 0 || height === 0 || now === this.drawn) return;
    this.drawn = now;
    const factor = Math.min(
      widest ? Infinity : most,
      (widestGap * width * pixel) / Math.max(widest ?? Math.abs(clearance), 1e-9),
      (widestMargin * width * pixel) / Math.max(margin, 1e-9),
    );
    const times = factor < 1.95 ? factor.toFixed(1) : factor.toFixed(0);
    const margins = isGuarded && margin > 0 ? `, margin ${millimetres(margin)}` : "";
    // The section of a body that is deeper than the section is wide is smaller than the view.
    set(this.times, factor < 1 ? "section" : `${times}×`);
    set(this.kept, widest ? ", end of the motion" : margins);
    const scale = factor / pixel;
    const middle = point.clone().addScaledVector(normal, 0.5 * clearance);
    const [right, up] = axesOf(contact, camera);
    const flat = (place: three.Vector3): [number, number] => {
      const way = place.clone().sub(middle);
      // Beside it, a clearance with more decimals has place.
      return [
        (widest ? 0.35 : 0.5) * width + scale * way.dot(right),
        0.5 * height - scale * way.dot(up),
      ];
    };

    const density = Math.min(devicePixelRatio, 2);
    this.canvas.width = Math.round(width * density);
    this.canvas.height = Math.round(height * density);
    const pen = this.canvas.getContext("2d") as CanvasRenderingContext2D;
    pen.scale(density, density);
    const reach = (0.7 * (width + height)) / scale;
    const pieces = cut(near, middle, [right, up], reach, flat);
    pen.save();
    if (widest) pen.clip(behind(pieces, width + height));
    this.drawSolid(pen, pieces, width, height);
    pen.restore();
    this.drawTool(pen, contact, flat, scale);
    this.drawGap(pen, contact, flat, [width, height]);
  }

  private drawSolid(
    pen: CanvasRenderingContext2D,
    pieces: readonly Piece[],
    width: number,
    height: number,
  ): void {
    pen.beginPath();
    for (let y = 0.5; y < height; ++y) {
      const crossings = pieces
        .filter(([, ay, , by]) => ay > y !== by > y)
        .map(([ax, ay, bx, by, nx]) => ({ x: ax + ((y - ay) / (by - ay)) * (bx - ax), nx }))
        // Beyond the picture some pieces are missing.
        .filter(({ x }) => x >= 0 && x <= width)
        .sort((a, b) => a.x - b.x);
      let isIn = crossings[0] ? crossings[0].nx > 0 : isInside(pieces, 0.5 * width, y);
      let from = 0;
      for (const { x, nx } of crossings) {
        if (isIn && nx > 0) pen.rect(from, y - 0.5, x - from, 1.05);
        // If a surface is open or meets itself, the direction decides.
        isIn = nx < 0;
        from = x;
      }
      if (isIn) pen.rect(from, y - 0.5, width - from, 1.05);
    }
    pen.fillStyle = this.solid;
    pen.fill();
    pen.save();
    pen.clip();
    pen.beginPath();
    for (let x = -height; x < width; x += hatch) {
      pen.moveTo(x, height);
      pen.lineTo(x + height, 0);
    }
    pen.globalAlpha = 0.22;
    pen.strokeStyle = this.edge;
    pen.lineWidth = 1;
    pen.stroke();
    pen.restore();
    pen.beginPath();
    for (const [ax, ay, bx, by] of pieces) {
      pen.moveTo(ax, ay);
      pen.lineTo(bx, by);
    }
    pen.lineCap = "round";
    pen.strokeStyle = this.edge;
    pen.lineWidth = 2;
    pen.stroke();
  }

  /** Draws the tool, and around it the shell of its margin. */
  private drawTool(
    pen: CanvasRenderingContext2D,
    { body, margin, isGuarded, widest }: Contact,
    flat: (place: three.Vector3) => [number, number],
    scale: number,
  ): void {
    const { [this.tool]: color = "", "--solid": ground = "" } = this.colors;
    const outline = (radius: number) => {
      const [[ax, ay], [bx, by]] = [flat(body.from), flat(body.to)];
      const along = Math.atan2(by - ay, bx - ax);
      pen.beginPath();
      pen.arc(ax, ay, scale * radius, along + Math.PI / 2, along + 1.5 * Math.PI);
      pen.arc(bx, by, scale * radius, along - Math.PI / 2, along + Math.PI / 2);
      pen.closePath();
    };
    pen.fillStyle = pen.strokeStyle = color;
    if (isGuarded && margin > 0) {
      outline(body.radius + margin);
      pen.globalAlpha = 0.25;
      pen.fill();
      pen.globalAlpha = 0.9;
      pen.setLineDash([4, 3]);
      pen.lineWidth = 1.2;
      pen.stroke();
      pen.setLineDash([]);
    }
    pen.globalAlpha = 0.92;
    outline(body.radius);
    pen.fill();
    pen.globalAlpha = 1;
    if (!widest) return;
    pen.strokeStyle = ground;
    pen.stroke();
  }

  /** Draws the tangent plane, and the clearance between tool and surface. */
  private drawGap(
    pen: CanvasRenderingContext2D,
    { point, normal, clearance, isHeld, widest }: Contact,
    flat: (place: three.Vector3) => [number, number],
    [width, height]: readonly [number, number],
  ): void {
    const {
      "--ink": ink = "",
      "--plane": plane = "",
      "--alarm": alarm = "",
      "--solid": ground = "",
    } = this.colors;
    const [x, y] = flat(point);
    const [u, v] = flat(point.clone().addScaledVector(normal, clearance));
    const outwards = flat(point.clone().add(normal));
    const [nx, ny] = unit(outwards[0] - x, outwards[1] - y);
    const far = width + height;
    pen.beginPath();
    pen.moveTo(x - far * ny, y + far * nx);
    pen.lineTo(x + far * ny, y - far * nx);
    pen.strokeStyle = isHeld ? plane : ink;
    pen.globalAlpha = isHeld ? 1 : 0.4;
    pen.lineWidth = isHeld ? 2 : 1;
    if (!widest) pen.stroke();
    pen.globalAlpha = 1;

    pen.beginPath();
    const ends = [
      [x, y],
      [u, v],
    ] as const;
    // A point needs no mark besides its dot.
    for (const [a, b] of widest ? ends.slice(0, 1) : ends) {
      pen.moveTo(a - 5 * ny, b + 5 * nx);
      pen.lineTo(a + 5 * ny, b - 5 * nx);
    }
    pen.moveTo(x, y);
    pen.lineTo(u, v);
    pen.strokeStyle = clearance < 0 && !widest ? alarm : ink;
    pen.lineWidth = 1.6;
    pen.stroke();

    // Beside the gap, along the plane.
    const text = millimetres(clearance, widest ? 3 : 2);
    pen.font = this.font;
    const long = pen.measureText(text).width + 10;
    const side = 14 + 0.5 * (Math.abs(ny) * long + Math.abs(nx) * 18);
    const turn = ny < 0 ? 1 : -1;
    const a = Math.min(Math.max((x + u) / 2 - turn * ny * side, long / 2), width - long / 2);
    const b = Math.min(Math.max((y + v) / 2 + turn * nx * side, 10), height - 10);
    pen.fillStyle = ground;
    pen.beginPath();
    pen.roundRect(a - long / 2, b - 9, long, 18, 9);
    pen.fill();
    pen.fillStyle = clearance < 0 ? alarm : ink;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillText(text, a, b);
  }
}

const unit = (x: number, y: number): [number, number] => {
  const length = Math.hypot(x, y) || 1;
  return [x / length, y / length];
};

/**
 * Returns the directions to the right and up in the plane of the section. The plane contains the
 * normal and, of an instrument, the axis; it is turned to the eye as far as possible.
 */
function axesOf({ normal, body }: Contact, camera: three.Camera): [three.Vector3, three.Vector3] {
  const axis = (number: number) =>
    new three.Vector3().setFromMatrixColumn(camera.matrixWorld, number);
  // A little from above, so that there is a plane also if the normal points to the eye.
  const toward = axis(2).addScaledVector(axis(1), 0.3);
  const along = body.to.clone().sub(body.from);
  const facing =
    along.lengthSq() > 1e-12
      ? along.cross(normal)
      : toward.clone().addScaledVector(normal, -toward.dot(normal));
  if (facing.lengthSq() < 1e-9) facing.copy(axis(0)).addScaledVector(normal, -axis(0).dot(normal));
  facing.normalize();
  if (facing.dot(toward) < 0) facing.negate();
  const right = axis(0).addScaledVector(facing, -axis(0).dot(facing));
  if (right.lengthSq() < 1e-6) right.copy(normal);
  right.normalize();
  return [right, facing.cross(right)];
}

/** Returns the section of the triangles within a distance of the middle. */
function cut(
  near: NearTriangles,
  middle: three.Vector3,
  [right, up]: readonly [three.Vector3, three.Vector3],
  reach: number,
  flat: (place: three.Vector3) => [number, number],
): Piece[] {
  const facing = right.clone().cross(up);
  const pieces: Piece[] = [];
  const normal = new three.Vector3();
  near.around(middle, reach, (triangle) => {
    const corners = [triangle.a, triangle.b, triangle.c];
    const depths = corners.map((corner) => corner.dot(facing) - middle.dot(facing));
    const ends: [number, number][] = [];
    for (let i = 0; i < 3; ++i) {
      const k = (i + 1) % 3;
      const [from, to] = [depths[i] as number, depths[k] as number];
      if (from > 0 === to > 0) continue;
      const [start, end] = [corners[i] as three.Vector3, corners[k] as three.Vector3];
      ends.push(flat(start.clone().lerp(end, from / (from - to))));
    }
    const [a, b] = ends;
    if (a === undefined || b === undefined) return;
    triangle.getNormal(normal);
    pieces.push([...a, ...b, normal.dot(right), -normal.dot(up)]);
  });
  return pieces;
}

/** Returns the pieces and what is behind them: a surface has no side beyond its rim. */
function behind(pieces: readonly Piece[], far: number): Path2D {
  const path = new Path2D();
  for (const [ax, ay, bx, by, nx, ny] of pieces) {
    const [u, v] = unit(nx, ny);
    // All in the same sense of rotation, so that two of them do not cancel each other.
    const isTurned = (bx - ax) * v > (by - ay) * u;
    const [px, py, qx, qy] = isTurned ? [bx, by, ax, ay] : [ax, ay, bx, by];
    path.moveTo(px + u, py + v);
    path.lineTo(qx + u, qy + v);
    path.lineTo(qx - far * u, qy - far * v);
    path.lineTo(px - far * u, py - far * v);
  }
  return path;
}

/** True if the piece that is nearest to a point of the picture faces away from it. */
function isInside(pieces: readonly Piece[], x: number, y: number): boolean {
  let [best, side] = [Infinity, 1];
  for (const [ax, ay, bx, by, nx, ny] of pieces) {
    const [dx, dy] = [bx - ax, by - ay];
    const share = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1);
    const t = Math.min(Math.max(share, 0), 1);
    const [wx, wy] = [x - ax - t * dx, y - ay - t * dy];
    const square = wx * wx + wy * wy;
    if (square >= best) continue;
    best = square;
    side = wx * nx + wy * ny;
  }
  return side < 0;
}
