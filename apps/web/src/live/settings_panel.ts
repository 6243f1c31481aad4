// SPDX-License-Identifier: BSD-3-Clause
import type { Rule, ToolSettings } from "../engine/keepout.ts";
import { element } from "./page.ts";

/** The controls for rule and lengths of a tool. */
export class SettingsPanel {
  private readonly radios = document.querySelectorAll<HTMLInputElement>("#rules input");
  private readonly sliders = (
    [
      ["tool-radius", "toolRadius"],
      ["margin", "margin"],
      ["radius", "radius"],
      ["opening", "opening"],
    ] as const
  )
    .filter(([id]) => document.getElementById(id))
    .map(([id, key]) => ({ slider: element(id, HTMLInputElement), key }));

  /** `change`: called with each setting that the user changes. */
  constructor(change: (part: Partial<ToolSettings>) => void) {
    for (const radio of this.radios) {
      radio.addEventListener("change", () => change({ rule: radio.value as Rule }));
    }
    for (const { slider, key } of this.sliders) {
      slider.addEventListener("input", () => change({ [key]: Number(slider.value) }));
    }
  }

  show(settings: ToolSettings): void {
    for (const radio of this.radios) radio.checked = radio.value === settings.rule;
    for (const { slider, key } of this.sliders) {
      // The page's initial value may be beyond the range of the slider.
      const value = settings[key] ?? 0;
      slider.min = String(Math.min(Number(slider.min), value));
      slider.max = String(Math.max(Number(slider.max), value));
      slider.value = String(value);
      const text = key === "opening" ? `${value}°` : `${value} mm`;
      slider.ariaValueText = text;
      const output = slider.parentElement?.querySelector("output");
      if (output) output.textContent = text;
    }
  }
}
