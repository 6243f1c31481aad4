// SPDX-License-Identifier: BSD-3-Clause

import { drawn, make } from "../page/elements.ts";
import { type Anatomy, cornersAround } from "./anatomy.ts";
import { AnatomyView } from "./anatomy_view.ts";
import { type Cut, closeUp, hang, markedCycle } from "./cut.ts";
import { extremes } from "./extremes.ts";
import { mark } from "./marks.ts";
import { coloured, parted, widths } from "./paths.ts";
import { valueAt } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { ordinal, pictureGrid, runColor, runName } from "./runs.ts";
import { millimetres, ruleName, show } from "./shown.ts";
import { clearanceCharts, showDepth, shownClearance } from "./simulation_charts.ts";
import {
  type Run,
  type SimulationRecord,
  type Stroke,
  tellingMoment,
  trespass,
} from "./simulation_record.ts";
import { strokeChooser, timeSlider } from "./time_slider.ts";

/** The distance up to which a tip touches. [mm] */
const touching = 1e-6;
export const outcomes: Readonly<Record<string, string>> = {
  f: "moved freely",
  l: "limited",
  s: "stopped",
};

/**
 * Returns one stroke: the anatomy cut open along it for each run, the nearest approach, and its
 * course in time.
 */
export function strokeSection(record: SimulationRecord, anatomy: Anatomy): HTMLElement {
  const isClosed = record.mesh.surface === "closed";
  const content = make("div");
  const chooser = strokeChooser(options(record), record.moment.stroke, (stroke) =>
    strokeView(record, anatomy, stroke, content),
  );
  return section(
    "One stroke, cut open",
    lead(
      "Stroke ",
      chooser,
      " along the path of the tip; the worst is shown first. ",
      ...(isClosed ? ["The anatomy is hatched. "] : []),
      make("b", {}, "Red"),
      record.has_convex_tool
        ? " is where the tool, which is not drawn, touches the surface or is inside. Distances are those of the whole tool. "
        : isClosed
          ? " is where the tip is inside it. "
          : " is where the tip has passed through the surface an odd number of times. ",
      "The label is at the worst moment, the balls are where the tip and, hollow, the hand are at the time chosen below.",
    ),
    content,
  );
}

function options({ runs, moment }: SimulationRecord): HTMLElement[] {
  const option = (stroke: number) => {
    const from = `/runs/0/strokes/${stroke}`;
    const { textContent } = ordinal(from);
    const attributes = { value: String(stroke), "data-from": from, "data-ordinal": "" };
    return make("option", attributes, textContent);
  };
  const others = (runs[0] as Run).strokes.map((_, stroke) => option(stroke));
  others.splice(moment.stroke, 1);
  return [
    make("optgroup", { label: "worst" }, option(moment.stroke)),
    make("optgroup", { label: "others" }, ...others),
  ];
}

/**
 * Fills a container with the pictures and plots of a stroke, and with the views that follow it in
 * time.
 */
function strokeView(
  record: SimulationRecord,
  anatomy: Anatomy,
  stroke: number,
  content: HTMLElement,
) {
  const moment = tellingMoment(record, stroke);
  const frame = closeUp(record, moment, anatomy);
  const cuts = record.runs.map(({ strokes }, number) => {
    const path = (strokes[stroke] as Stroke).tip.map(anatomy.placed);
    return hang(path, markedCycle(record, number, moment, frame, anatomy), frame);
  });
  const front = extremes(cuts.flatMap(({ depths }) => [...depths]))[1];
  const near = cornersAround(anatomy, frame.target, frame.toward, 2 * frame.height, front);
  const group = pictureGrid(record.runs.length);
  const view = new AnatomyView(group, anatomy, near, frame, true);
  const followed = record.runs.map((run, number) => {
    const { tip, outcome } = run.strokes[stroke] as Stroke;
    const path = tip.map(anatomy.placed);
    const hand = (record.hand[stroke] ?? []).map(anatomy.placed);
    const worst = markedCycle(record, number, moment, frame, anatomy);
    const isBad = trespass(run, stroke, record);
    const { good, bad } = parted(path, isBad, 1e-3 * frame.height);
    const lengths = coloured(good, bad, runColor(number), widths.near);
    const cut = cuts[number] as Cut;
    const at = (cycle: number) => path[cycle] as (typeof path)[number];
    const label = distance(record, clearanceAt(number, stroke, worst), isBad[worst] === true);
    const kind = isBad[worst] ? "worst bad" : "worst";
    const marks = {
      worst: mark(kind, at(worst), 5, label),
      hand: mark("hand", at(worst), 6),
      tool: mark("tool", at(worst), 6),
    };
    for (const { element } of Object.values(marks)) {
      element.style.setProperty("--color", `var(${runColor(number)})`);
    }
    const now = make("span", { class: "now" });
    const description = `Section along the path of the tip, ${ruleName(run.name)}: ${label.textContent}.`;
    view.add(description, { lengths, cut }, Object.values(marks), runName(number), now);
    return (cycle: number) => {
      marks.tool.place = at(cycle);
      marks.hand.place = hand[cycle] ?? at(cycle);
      const clearance = shownClearance(record, clearanceAt(number, stroke, cycle));
      now.replaceChildren(clearance, `, ${outcomes[outcome[cycle] as string]}`);
    };
  });
  const charts = clearanceCharts(record, stroke);
  const time = timeSlider(
    view,
    `/runs/0/strokes/${stroke}/tip`,
    (record.runs[0] as Run).strokes[stroke]?.tip.length ?? 1,
    (cycle) => {
      for (const follow of followed) follow(cycle);
      view.placeMarks();
      charts.follow(cycle);
    },
  );
  time.go(moment.cycle);
  content.replaceChildren(group, time.element, ...charts.elements);
  return time;
}

/** Returns the pointer to the clearance of a cycle. */
export const clearanceAt = (run: number, stroke: number, cycle: number): string =>
  `/runs/${run}/strokes/${stroke}/clearance_mm/${cycle}`;

/**
 * Returns the depth or distance of a tool. Beyond an open surface, the distance of a tip is not a
 * depth.
 */
export function distance(record: SimulationRecord, from: string, isBad: boolean): SVGTSpanElement {
  const label = drawn("tspan", {});
  const clearance = Number(valueAt(from));
  if (isBad && clearance < 0) return showDepth(label, record, from);
  if (!isBad && Math.abs(clearance) > touching)
    return show(label, from, (mm) => `${millimetres(mm)} away`);
  const passed = record.has_convex_tool ? "touched" : "passed through";
  label.textContent = isBad ? passed : "touching";
  return label;
}
