// SPDX-License-Identifier: BSD-3-Clause

import type * as three from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { drawn, make } from "../page/elements.ts";
import { type Graphics, makeGraphics } from "../page/graphics.ts";
import type { Shading } from "../page/shading.ts";
import type { Anatomy, Outlook } from "./anatomy.ts";
import { type Mark, placeMarks, scaleBar } from "./marks.ts";
import { GraphicsPainter, type Layer, type Painter } from "./painting.ts";
import { StillPainter } from "./still.ts";

/** The delay after the last motion of a view until it is drawn at full resolution. [ms] */
const rest = 160;
/** The rotation and the zoom of a key. */
const [turn, zoom] = [0.12, 1.15];

let shared: Graphics | null | undefined;

/**
 * Returns the WebGL graphics that all pictures of the page share, a new one after a loss; null
 * without WebGL.
 */
function sharedGraphics(): Graphics | null {
  if (shared !== undefined) return shared;
  try {
    shared = makeGraphics(true);
  } catch {
    shared = null;
  }
  return shared;
}

interface Picture {
  readonly element: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  readonly marks: readonly Mark[];
  readonly scale: SVGGElement;
  readonly layer: Layer;
  readonly controls: OrbitControls;
  isInSight: boolean;
  isStale: boolean;
}

/** Pictures of one anatomy with the same view: when one is turned, all turn. */
export class AnatomyView {
  private readonly pictures: Picture[] = [];
  private painter: Painter;
  private isSlow = true;
  private readonly end = new AbortController();
  private isDue = false;
  private isMoving = false;
  private settling = 0;
  private readonly sight = new IntersectionObserver((changes) => {
    for (const { target, isIntersecting } of changes) {
      const picture = this.pictures.find(({ element }) => element === target);
      if (picture) picture.isInSight = isIntersecting;
    }
    this.redraw();
  });
  private readonly sizes = new ResizeObserver(() => this.outdate());

  /**
   * `group`: the element around the pictures, which states the direction of the view. `isCut`: true
   * for each picture that shows a cut.
   */
  constructor(
    private readonly group: HTMLElement,
    anatomy: Anatomy,
    corners: Uint32Array,
    private readonly outlook: Outlook,
    isCut = false,
  ) {
    const { signal } = this.end;
    const { camera } = outlook;
    let shaded: Shading | null = null;
    const begin = (): Painter => {
      const graphics = sharedGraphics();
      this.isSlow = graphics?.isSlow ?? true;
      if (!graphics) return new StillPainter(anatomy, corners, camera);
      const lost = () => {
        if (shared === graphics) shared = undefined;
        this.painter = begin();
        this.outdate();
      };
      graphics.renderer.domElement.addEventListener("webglcontextlost", lost, { signal });
      const painter = new GraphicsPainter(graphics, anatomy, corners, camera, isCut);
      if (shaded !== null) painter.shade(shaded);
      return painter;
    };
    this.painter = begin();
    void anatomy.shading.then((shading) => {
      if (signal.aborted) return;
      shaded = shading;
      this.painter.shade(shading);
      this.outdate();
    });
    const dark = window.matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.outdate(), { signal });
    const printing = () => {
      this.isMoving = false;
      for (const picture of this.pictures) this.paint(picture);
    };
    window.addEventListener("beforeprint", printing, { signal });
    this.tellView();
  }

  /** Adds another picture to the group, above a caption. */
  add(
    description: string,
    layer: Layer,
    marks: readonly Mark[],
    ...caption: readonly (Node | string)[]
  ): void {
    const canvas = make("canvas", { class: "anatomy" });
    const scale = drawn("g", { class: "scale" }, drawn("path", {}), drawn("text", {}));
    const overlay = drawn("svg", {}, ...marks.map(({ element }) => element), scale);
    const element = make("div", { class: "picture", tabindex: "0", role: "img" }, canvas);
    element.setAttribute("aria-label", description);
    element.append(overlay);
    const controls = this.controlled(element);
    this.pictures.push({
      ...{ element, canvas, marks, scale, layer, controls },
      ...{ isInSight: false, isStale: true },
    });
    this.sight.observe(element);
    this.sizes.observe(element);
    this.group.append(make("figure", {}, element, make("figcaption", {}, ...caption)));
  }

  /** Updates the positions of the marks of all pictures. */
  placeMarks(): void {
    for (const picture of this.pictures) this.mark(picture);
  }

  dispose(): void {
    this.end.abort();
    this.sight.disconnect();
    this.sizes.disconnect();
    for (const { controls } of this.pictures) controls.dispose();
    this.pictures.length = 0;
    this.painter.dispose();
  }

  private controlled(element: HTMLElement): OrbitControls {
    // The wheel zooms in a picture that was clicked, or with Ctrl; else it scrolls the page.
    element.addEventListener("wheel", ({ ctrlKey }) => {
      controls.enableZoom = ctrlKey || document.activeElement === element;
    });
    element.addEventListener("pointerdown", ({ pointerType }) => {
      controls.enableZoom = true;
      // A vertical motion of a finger scrolls the page, unless the picture was tapped.
      const scrolls = pointerType === "touch" && document.activeElement !== element;
      controls.minPolarAngle = scrolls ? controls.getPolarAngle() : 0;
      controls.maxPolarAngle = scrolls ? controls.getPolarAngle() : Math.PI;
    });
    const controls = new OrbitControls(this.outlook.camera, element);
    controls.target = this.outlook.target;
    controls.minZoom = 0.5;
    controls.maxZoom = 200;
    controls.saveState();
    controls.update();
    this.outlook.camera.updateMatrixWorld();
    controls.addEventListener("change", () => this.moved());
    const keys: Readonly<Record<string, () => void>> = {
      ArrowLeft: () => controls.rotateLeft(-turn),
      ArrowRight: () => controls.rotateLeft(turn),
      ArrowUp: () => controls.rotateUp(-turn),
      ArrowDown: () => controls.rotateUp(turn),
      "+": () => controls.dollyOut(zoom),
      "-": () => controls.dollyIn(zoom),
      Home: () => controls.reset(),
    };
    element.addEventListener("keydown", (event) => {
      const act = keys[event.key];
      if (!act || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      act();
    });
    element.addEventListener("dblclick", () => controls.reset());
    return controls;
  }

  private moved(): void {
    this.outlook.camera.updateMatrixWorld();
    this.painter.outdate();
    this.isMoving = true;
    this.outdate();
    this.tellView();
    window.clearTimeout(this.settling);
    this.settling = window.setTimeout(() => {
      this.isMoving = false;
      this.outdate();
    }, rest);
  }

  private tellView(): void {
    const { camera, target } = this.outlook;
    const toward = camera.position.clone().sub(target).normalize();
    this.group.dataset.view = [...toward.toArray(), camera.zoom]
      .map((value) => value.toFixed(3))
      .join(",");
  }

  /** Draws all pictures again, because their content or their view has changed. */
  outdate(): void {
    for (const picture of this.pictures) picture.isStale = true;
    this.redraw();
  }

  /** Draws with the browser's next frame: first the visible pictures, then, at rest, all others. */
  private redraw(): void {
    if (this.isDue || this.pictures.length === 0) return;
    this.isDue = true;
    requestAnimationFrame(() => {
      this.isDue = false;
      const stale = this.pictures.filter(({ isStale }) => isStale);
      const seen = stale.filter(({ isInSight }) => isInSight);
      const now = seen.length > 0 || this.isMoving ? seen : stale.slice(0, 1);
      for (const picture of now) this.paint(picture);
      if (stale.length > now.length && !this.isMoving) this.redraw();
    });
  }

  private paint(picture: Picture): void {
    const { element, canvas, layer } = picture;
    const { clientWidth: width, clientHeight: height } = element;
    if (width === 0 || height === 0) return;
    const density = Math.min(window.devicePixelRatio, 2);
    canvas.width = Math.round(width * density);
    canvas.height = Math.round(height * density);
    const coarse = this.isSlow ? 0.6 : density;
    const source = this.painter.paint(layer, width, height, this.isMoving ? coarse : 2);
    const pen = canvas.getContext("2d") as CanvasRenderingContext2D;
    pen.imageSmoothingQuality = "high";
    pen.drawImage(source, 0, 0, canvas.width, canvas.height);
    picture.isStale = false;
    this.mark(picture);
  }

  private mark({ element, layer, marks, scale }: Picture): void {
    const { clientWidth: width, clientHeight: height } = element;
    if (width === 0) return;
    const { camera } = this.outlook;
    // On paper the picture has another size, but is not drawn again.
    scale.ownerSVGElement?.setAttribute("viewBox", `0 0 ${width} ${height}`);
    placeMarks(marks, layer.lengths, camera, width, height);
    scaleBar(scale, (camera.top - camera.bottom) / camera.zoom / height, width, height);
  }
}

/** Explains to the reader how to use the pictures, and without WebGL why they are simpler. */
export const hint = (pictures: number): HTMLElement =>
  make(
    "p",
    { class: "hint" },
    pictures > 1 ? "Drag to turn: all turn together. " : "Drag to turn. ",
    "Ctrl and the wheel zoom, or the wheel alone in a picture that was clicked; so do two fingers. ",
    "Arrow keys turn, + and − zoom, Home or a double click goes back.",
    ...(sharedGraphics() ? [] : [" There is no WebGL here: the pictures are plain."]),
  );

/**
 * Returns the direction from which most places are visible, among directions all around and
 * slightly above.
 */
export function bestDirection(
  directions: readonly three.Vector3[],
  seenFrom: (toward: three.Vector3) => number,
): three.Vector3 {
  const counts = directions.map(seenFrom);
  return directions[counts.indexOf(Math.max(...counts))] as three.Vector3;
}
