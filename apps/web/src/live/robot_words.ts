// SPDX-License-Identifier: BSD-3-Clause
/** The sentences of the page of an instrument about a cycle. The names of statuses are those of docs/safety.md. */
import type { Rule, ToolFacts } from "../engine/keepout.ts";
import type { AnatomyWords } from "./anatomy_words.ts";
import { millimetres } from "./page.ts";
import type { State } from "./protocol.ts";
import { firstJaw, reachedBody } from "./robot_surroundings.ts";
import { type StatusShown, statusShown } from "./status_words.ts";

const without: Partial<Record<Rule, string>> = {
  none: "nothing stops it",
  tip_only: "only the tip is guarded",
};

/** Returns the chip and the sentence of the status card. */
export function robotStatusShown(
  name: string,
  state: State,
  { bodies }: ToolFacts,
  rule: Rule,
  { surface }: AnatomyWords,
): StatusShown {
  const body = reachedBody(state, state.clearances);
  const clearance = state.clearances[body] ?? Number.NaN;
  const who = `The ${bodies[body]?.name}`;
  if (clearance < 0) {
    const end = without[rule] ?? "it stands still";
    const sentence = `${who} is ${millimetres(-clearance)} deep in ${surface}: ${end}.`;
    return { chip: "inside", sentence, mood: "stopped" };
  }
  const isGuarded = rule !== "none";
  const usual = statusShown(name, state, isGuarded);
  if (!isGuarded || body < 0) {
    const sentence = usual.sentence.replaceAll("the tool", "the instrument");
    return { ...usual, sentence };
  }
  const stop =
    rule === "tip_only"
      ? `The tip of the jaw has stopped at ${surface}: only the tip is guarded.`
      : `${surface.charAt(0).toUpperCase()}${surface.slice(1)} stops ${who.toLowerCase()}: ${millimetres(clearance)} of clearance remains.`;
  return { ...usual, sentence: stop };
}

/** Returns where the end of the jaw and the hand are, if that is hard to see; else "". */
export function whereabouts(
  { surroundings, clearances }: State,
  rule: Rule,
  { surface, hollow }: AnatomyWords,
): string {
  if (surroundings === null) return "";
  const isJawOut = Math.min(...clearances.slice(firstJaw)) >= 0;
  const jaw =
    surroundings.isEnclosed && isJawOut
      ? `The jaw is in the hollow of ${hollow}, outside of ${surface}.`
      : "";
  const hand = surroundings.isHandBehind && rule !== "none" ? `The hand is behind ${surface}.` : "";
  return [jaw, hand].filter((sentence) => sentence !== "").join(" ");
}
