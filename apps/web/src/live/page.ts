// SPDX-License-Identifier: BSD-3-Clause
import type { EmbeddedMesh } from "./protocol.ts";

/** What `keepout live` has put into the page beside the meshes. */
export interface PageSettings {
  readonly keepout: string;
  readonly activation: string;
  readonly radius: number;
  readonly tool_radius: number;
  readonly margin: number;
  readonly max_step: number;
  readonly guides: readonly string[];
  /** Of an instrument; a tip has none. */
  readonly robot?: string;
  readonly meshes: readonly EmbeddedMesh[];
}

/** The element of a name, which the page has. */
export function element<T extends HTMLElement>(id: string, type: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof type)) throw new Error(`the page has no ${id}`);
  return found;
}

/** The text of a script element that holds data. */
export function embeddedText(id: string): string {
  return document.getElementById(id)?.textContent ?? "";
}

export const page: PageSettings = JSON.parse(embeddedText("settings"));

/** Whether the tool is the ball of a tip, or else an instrument. */
export const isTip = page.robot === undefined;

/** The element of an identifier shows a text: changed where it has changed, as a screen reader shall not hear what has not. */
export function set(where: string | Element | null, text: string): void {
  const place = typeof where === "string" ? document.getElementById(where) : where;
  if (place && place.textContent !== text) place.textContent = text;
}

export const millimetres = (length: number): string => `${length.toFixed(2)} mm`;

/** The share of the view's width between the columns of cards; on a phone they are below it. */
export function roomBetweenCards(view: HTMLElement): number {
  const column = document.querySelector(".column")?.getBoundingClientRect().right ?? 0;
  return Math.max(1 - (2 * (column + 40)) / view.clientWidth, 0.3);
}

/** A scene in the view; where it cannot be made, the page says why. */
export function made<T>(makeScene: () => T): T {
  try {
    return makeScene();
  } catch (error) {
    element("loading", HTMLElement).textContent =
      "This browser draws nothing here: WebGL 2 is missing, or switched off.";
    throw error;
  }
}

let toastEnd: ReturnType<typeof setTimeout> | undefined;

/** A word to the user, for as long as it takes to read. */
export function toast(text: string): void {
  const line = element("toast", HTMLElement);
  line.textContent = text;
  line.hidden = false;
  clearTimeout(toastEnd);
  const end = () => {
    line.hidden = true;
  };
  toastEnd = setTimeout(end, 3000 + 55 * text.length);
}
