// SPDX-License-Identifier: BSD-3-Clause
import type { Frame, InstrumentFacts } from "../engine/manipulator.ts";
import type { InstrumentState } from "./instrument_protocol.ts";
import { element, millimetres, set } from "./page.ts";
import { StatusLine, type StatusWords } from "./status_line.ts";

/** The number of the body that is held back: the one nearest to the surface while something holds; else -1. */
export const heldBody = ({ rows, nearest }: InstrumentState): number => (rows > 0 ? nearest : -1);

/** The card that tells what keepout does with the instrument. */
export class InstrumentReadings {
  private readonly line: StatusLine;

  private readonly rows = new Map<string, HTMLElement>();

  constructor(statuses: readonly StatusWords[]) {
    this.line = new StatusLine(statuses);
  }

  /** `frames`: drawn since the beginning. */
  show(state: InstrumentState, { bodies }: InstrumentFacts, margin: number, frames: number): void {
    this.line.show(state, true, frames);
    const least = Math.min(...state.clearances);
    const nearest = state.clearances.indexOf(least);
    const figure = element("clearance", HTMLElement);
    figure.parentElement?.classList.toggle("inside", least < 0);
    set(figure, millimetres(least));
    set("clearance-words", `from the ${bodies[nearest]?.name} to the surface`);
    const held = heldBody(state);
    set("held", held < 0 ? "nothing" : `by the ${bodies[held]?.name}`);
    bodies.forEach(({ name }, i) => {
      const row = this.rowOf(name);
      set(row, millimetres(state.clearances[i] as number));
      row.className = i === held ? "held" : "";
    });
    const { hand, flange } = state;
    const way = Math.hypot(...hand.place.map((value, i) => value - (flange.place[i] as number)));
    set("hand-off", `${millimetres(way)}, ${degreesBetween(hand, flange).toFixed(0)}°`);
    set("margin-kept", millimetres(margin));
    set("planes", `${state.rows}`);
    set("rounds", `${state.rounds}`);
  }

  /** Where the clearance of a body stands. */
  private rowOf(body: string): HTMLElement {
    let row = this.rows.get(body);
    if (row === undefined) {
      row = document.createElement("dd");
      const name = document.createElement("dt");
      name.textContent = `From the ${body}`;
      element("bodies", HTMLElement).append(name, row);
      this.rows.set(body, row);
    }
    return row;
  }
}

function degreesBetween(a: Frame, b: Frame): number {
  const cosine = Math.abs(a.turn.reduce((sum, value, i) => sum + value * (b.turn[i] as number), 0));
  return (360 / Math.PI) * Math.acos(Math.min(cosine, 1));
}
