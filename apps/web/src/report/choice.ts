// SPDX-License-Identifier: BSD-3-Clause
import { make } from "./shown.ts";

/** One of several contents of which one at a time is seen. */
export interface Choice {
  readonly label: readonly (Node | string)[];
  readonly content: HTMLElement;
}

let groups = 0;

/** Shows the content that is chosen by its label. Print shows all, which is why they have titles. */
export function choice(title: string, choices: readonly Choice[]): HTMLElement[] {
  if (choices.length < 2) return choices.map(({ content }) => content);
  const group = `choice-${groups++}`;
  const buttons = choices.map(({ label, content }, i) => {
    const button = make("input", {
      type: "radio",
      name: group,
      ...(i === 0 ? { checked: "" } : {}),
    });
    button.addEventListener("change", () => {
      for (const other of choices)
        other.content.classList.toggle("unchosen", other.content !== content);
    });
    content.classList.toggle("unchosen", i > 0);
    return make("label", {}, button, make("span", {}, ...label));
  });
  return [
    make("fieldset", { class: "choice" }, make("legend", {}, title), ...buttons),
    ...choices.map(({ content }) => content),
  ];
}
