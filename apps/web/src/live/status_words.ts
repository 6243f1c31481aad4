// SPDX-License-Identifier: BSD-3-Clause
import type { State } from "./protocol.ts";

/** The meaning of a status for the user of the page. The names are those of docs/safety.md. */
const words: Readonly<Record<string, string>> = {
  free: "the tool follows the hand",
  recovering: "the tool was closer than its margin, and moves away",
  truncated: "only a part of the motion could be proved: the tool makes that part",
  infeasible: "the surface is too close on several sides: move the hand back",
  inside: "the tool is inside the anatomy: choose “Start over”, or double-click the surface",
  touching: "the tool touches the surface: choose “Start over”",
  margin_too_small: "the margin is too small for a mesh of this size: make it larger",
  beyond_reach: "the motion is longer than the motion sphere: make the sphere larger",
  over_capacity: "too many triangles are near the tool: make the motion sphere smaller",
  out_of_budget: "the cycle ended before a motion was proved: the tool waits",
  unconfirmed: "the monitor did not confirm the motion: the tool waits",
  unsolved: "no motion could be proved in this direction: move the hand another way",
};

/** The chip and the sentence of the status card, and its color. */
export interface StatusShown {
  readonly chip: string;
  readonly sentence: string;
  readonly mood: "free" | "limited" | "stopped" | "unguarded";
}

const moving: readonly string[] = ["limited", "recovering", "truncated", "degraded"];

/** Returns what the page says about a cycle. `isGuarded`: false without a fixture. */
export function statusShown(
  name: string,
  { clearances, byMesh, guides }: State,
  isGuarded: boolean,
): StatusShown {
  const isInside = Math.min(...clearances) < 0;
  if (!isGuarded) {
    return isInside
      ? { chip: "inside", sentence: "no fixture: nothing stops the tool", mood: "stopped" }
      : { chip: "no fixture", sentence: "nothing stops the tool", mood: "unguarded" };
  }
  const mood = name === "free" ? "free" : moving.includes(name) ? "limited" : "stopped";
  return {
    chip: name.replaceAll("_", " "),
    sentence: sentenceOf(name, byMesh, guides > 0),
    mood: isInside ? "stopped" : mood,
  };
}

function sentenceOf(name: string, byMesh: boolean, byGuide: boolean): string {
  if (name !== "limited") return words[name] ?? "the tool stands still";
  if (byMesh && byGuide) return "surface and guide limit the motion";
  if (byMesh) return "the surface is in the way: the tool slides along it";
  return byGuide ? "the guide limits the motion" : "the joints limit the motion";
}
