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

/** For people: 1,234,567. */
export const grouped = (count: number): string => Math.round(count).toLocaleString("en");

let toastEnd: ReturnType<typeof setTimeout> | undefined;

/** A word to the user, for as long as it takes to read. */
export function toast(text: string): void {
  const line = element("toast", HTMLElement);
  line.textContent = text;
  line.hidden = false;
  clearTimeout(toastEnd);
  toastEnd = setTimeout(
    () => {
      line.hidden = true;
    },
    3000 + 55 * text.length,
  );
}
