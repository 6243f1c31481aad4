// SPDX-License-Identifier: BSD-3-Clause
import type { Guide, ToolSettings } from "../engine/keepout.ts";
import { element } from "./page.ts";

export type GuideKind = Guide["kind"];

const isKind = (value: string): value is GuideKind =>
  ["half_space", "slab", "tube", "ball"].includes(value);

/**
 * Lets the user choose guidance constraints: a kind, which is fitted to the tool's position, or
 * texts as for `--guide`, separated by blanks.
 */
export class GuidePanel {
  private readonly kinds = element("guide", HTMLSelectElement);
  private readonly texts = element("guide-text", HTMLInputElement);
  private fitted: { kind: GuideKind; text: string } | null = null;

  /** `fit`: returns the text of a guide of a kind, or null while there is no tool. */
  constructor(
    fit: (kind: GuideKind) => string | null,
    change: (part: Pick<ToolSettings, "guides">) => void,
  ) {
    this.kinds.addEventListener("change", () => {
      const kind = this.kinds.value;
      const text = isKind(kind) ? fit(kind) : null;
      this.fitted = isKind(kind) && text !== null ? { kind, text } : null;
      this.texts.hidden = kind === "none";
      if (kind === "text") this.texts.focus();
      else change({ guides: text === null ? [] : [text] });
    });
    this.texts.addEventListener("change", () => change({ guides: this.written() }));
  }

  show({ guides }: ToolSettings): void {
    const text = guides.join(" ");
    const kind = this.fitted?.text === text ? this.fitted.kind : "text";
    this.kinds.value = guides.length === 0 ? "none" : kind;
    this.texts.value = text;
    this.texts.title = text;
    this.texts.hidden = guides.length === 0;
  }

  /**
   * Returns the guides for another anatomy: written ones, but no guides that were fitted to this
   * one.
   */
  forAnother(guides: readonly string[]): readonly string[] {
    return this.fitted?.text === guides.join(" ") ? [] : guides;
  }

  private written(): string[] {
    return this.texts.value.split(/\s+/).filter((text) => text !== "");
  }
}
