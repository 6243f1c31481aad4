// SPDX-License-Identifier: BSD-3-Clause
import { make, signed } from "../page/elements.ts";
import type { EmbeddedMesh } from "./protocol.ts";

/** The settings that `keepout live` has put into the page, besides the meshes. */
export interface PageSettings {
  readonly keepout: string;
  readonly activation: string;
  readonly radius: number;
  readonly tool_radius: number;
  readonly margin: number;
  readonly max_step: number;
  readonly guides: readonly string[];
  /** Set for an instrument only. */
  readonly robot?: string;
  readonly meshes: readonly EmbeddedMesh[];
}

/** Returns the element of this name. Precondition: the page has it. */
export function element<T extends HTMLElement>(id: string, type: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof type)) throw new Error(`the page has no ${id}`);
  return found;
}

/** Returns the text of a script element with data. */
export function embeddedText(id: string): string {
  return document.getElementById(id)?.textContent ?? "";
}

export const page: PageSettings = JSON.parse(embeddedText("settings"));

/** True if the tool is the ball of a tip, false if it is an instrument. */
export const isTip = page.robot === undefined;

/**
 * Shows a text in an element. Changes it only if it differs, so that a screen reader does not
 * repeat it.
 */
export function set(where: string | Element | null, text: string): void {
  const place = typeof where === "string" ? document.getElementById(where) : where;
  if (place && place.textContent !== text) place.textContent = text;
}

export const millimetres = (length: number, digits = 2): string =>
  `${signed(length.toFixed(digits))} mm`;

/** The free width on the inner side of each column of cards. [px] */
export const besideCards = 40;

/**
 * Returns the fraction of the view's width between the columns of cards; on a phone they are below
 * it.
 */
export function roomBetweenCards(view: HTMLElement): number {
  const column = document.querySelector(".column")?.getBoundingClientRect().right ?? 0;
  return Math.max(1 - (2 * (column + besideCards)) / view.clientWidth, 0.3);
}

/** Returns the scene of the view; if it cannot be created, the page shows why. */
export function made<T>(makeScene: () => T): T {
  try {
    return makeScene();
  } catch (error) {
    element("loading", HTMLElement).textContent =
      "This browser draws nothing here: WebGL 2 is missing, or switched off.";
    throw error;
  }
}

/** Reports a lost WebGL context. The browser gives it back, or the user must reload the page. */
export function reportGraphics(canvas: HTMLCanvasElement): void {
  const line = element("loading", HTMLElement);
  let patience: ReturnType<typeof setTimeout> | undefined;
  canvas.addEventListener("webglcontextlost", () => {
    line.textContent = "The graphics stopped; the browser starts them again …";
    line.hidden = false;
    patience = setTimeout(() => {
      line.textContent = "The graphics stopped: reload this page.";
    }, 5000);
  });
  canvas.addEventListener("webglcontextrestored", () => {
    clearTimeout(patience);
    line.hidden = true;
  });
}

let toastEnd: ReturnType<typeof setTimeout> | undefined;

/** Shows a message to the user, long enough to read it, with a button if there is an answer. */
export function toast(text: string, answer?: { name: string; act: () => void }): void {
  const line = element("toast", HTMLElement);
  line.replaceChildren(text);
  if (answer !== undefined) {
    const button = make("button", { type: "button" }, answer.name);
    button.onclick = () => {
      line.hidden = true;
      answer.act();
    };
    line.append(" ", button);
  }
  line.hidden = false;
  clearTimeout(toastEnd);
  const end = () => {
    line.hidden = true;
  };
  toastEnd = setTimeout(end, 3000 + 55 * text.length + (answer === undefined ? 0 : 20_000));
}
