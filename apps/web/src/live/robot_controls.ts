// SPDX-License-Identifier: BSD-3-Clause
import { element } from "./page.ts";
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
