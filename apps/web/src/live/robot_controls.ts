// SPDX-License-Identifier: BSD-3-Clause
import type { ToolFacts } from "../engine/keepout.ts";
import { element, millimetres, set } from "./page.ts";
import type { State } from "./protocol.ts";
import type { RobotScene } from "./robot_scene.ts";

/** Connects the controls that only the page of an instrument has. */
export function addRobotControls(scene: RobotScene): void {
  const closer = element("closer", HTMLButtonElement);
  closer.onclick = () => {
    const isClose = closer.getAttribute("aria-pressed") !== "true";
    closer.setAttribute("aria-pressed", String(isClose));
    if (isClose) scene.showJaws();
    else scene.showAll();
  };
}

/** Writes the body and its clearance beside the contact in the view. */
export function labelContact(
  scene: RobotScene,
  { surroundings, clearances }: State,
  { bodies }: ToolFacts,
): void {
  const label = element("contact", HTMLElement);
  const contact = surroundings?.contact ?? null;
  label.hidden = contact === null;
  if (contact === null) return;
  const clearance = clearances[contact.body] as number;
  label.className = clearance < 0 ? "inside" : "";
  set(label, `${bodies[contact.body]?.name} ${millimetres(clearance)}`);
  label.style.transform = scene.shift(contact.surface);
}
