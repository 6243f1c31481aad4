// SPDX-License-Identifier: BSD-3-Clause
/** The first figure of `simulate`: commanded path and tool path in one section of the anatomy. */
import type * as three from "three";
import { make } from "../page/elements.ts";
import { type Anatomy, cornersAround } from "./anatomy.ts";
import { AnatomyView } from "./anatomy_view.ts";
import { closeUp, hang, markedCycle } from "./cut.ts";
import { extremes } from "./extremes.ts";
import { type Mark, mark } from "./marks.ts";
import { coloured, parted, widths } from "./paths.ts";
import { ordinal, runColor, runName, swatched } from "./runs.ts";
import { shownClearance } from "./simulation_charts.ts";
import { bestRun, type Run, type SimulationRecord, trespass } from "./simulation_record.ts";
import { clearanceAt, distance, outcomes } from "./stroke.ts";
import { timeSlider } from "./time_slider.ts";

/** Returns the most informative stroke, with the paths of the rule that failed and of the best. */
export function heroFigure(record: SimulationRecord, anatomy: Anatomy): HTMLElement {
  const { moment, runs } = record;
  const { stroke } = moment;
  const isClosed = record.mesh.surface === "closed";
  const frame = closeUp(record, moment, anatomy);
  const hand = (record.hand[stroke] ?? []).map(anatomy.placed);
  const cut = hang(hand, moment.cycle, frame);
  const near = cornersAround(
    anatomy,
    frame.target,
    frame.toward,
    2 * frame.height,
    extremes(cut.depths)[1],
  );
  const failed = runs[moment.run]?.rule === "none" ? [] : [moment.run];
  const shownRuns = [...new Set([...failed, bestRun(runs)])];
  const free = runs.findIndex(({ rule }) => rule === "none");
  const isInside = free < 0 ? [] : trespass(runs[free] as Run, stroke, record);
  const ways = parted(hand, isInside, 1e-3 * frame.height);
  const commanded = coloured(ways.good, ways.bad, "--commanded", widths.many, true);
  const handMarks = [mark("hand", hand[moment.cycle] ?? frame.target, 6)];
  if (free >= 0 && failed.length === 0) {
    const worst = markedCycle(record, free, moment, frame, anatomy);
    const label = distance(record, clearanceAt(free, stroke, worst), isInside[worst] === true);
    handMarks.push(mark("hand bad", hand[worst] ?? frame.target, 0, label));
  }
  const now = shownRuns.map(() => make("span", { class: "now" }));
  const drawnRuns = shownRuns.map((number, place) => {
    const run = runs[number] as Run;
    const { tip, outcome } = run.strokes[stroke] as Run["strokes"][number];
    const path = tip.map(anatomy.placed);
    const isBad = trespass(run, stroke, record);
    const { good, bad } = parted(path, isBad, 1e-3 * frame.height);
    const worst = markedCycle(record, number, moment, frame, anatomy);
    const at = (cycle: number) => path[cycle] as (typeof path)[number];
    const label = distance(record, clearanceAt(number, stroke, worst), isBad[worst] === true);
    const marks = {
      worst: mark(isBad[worst] ? "worst bad" : "worst", at(worst), 5, label),
      tool: mark("tool", at(worst), 6),
    };
    const color = runColor(number);
    for (const { element } of Object.values(marks)) {
      element.style.setProperty("--color", `var(${color})`);
    }
    return {
      lengths: coloured(good, bad, color, widths.near, true),
      marks: Object.values(marks),
      follow: (cycle: number) => {
        marks.tool.place = at(cycle);
        const clearance = shownClearance(record, clearanceAt(number, stroke, cycle));
        now[place]?.replaceChildren(clearance, `, ${outcomes[outcome[cycle] as string]}`);
      },
    };
  });
  // The paths of the tool hide the commanded path where both agree.
  const paths = shownRuns.flatMap((run) =>
    (runs[run]?.strokes[stroke]?.tip ?? []).map(anatomy.placed),
  );
  const isHidden = (place: three.Vector3) =>
    paths.some((tip) => tip.distanceTo(place) < 0.01 * frame.height);
  const isSeen = hand.some((place, i) => {
    const { x, y } = place.clone().project(frame.camera);
    return !isInside[i] && Math.max(Math.abs(x), Math.abs(y)) < 1 && !isHidden(place);
  });
  const beyond = record.has_convex_tool ? "in contact" : isClosed ? "inside" : "beyond the surface";
  const commandedNames = [
    ...(isSeen ? [swatched("--commanded", "commanded path")] : []),
    ...(ways.bad.length > 0 ? [swatched("--alarm", `commanded path, ${beyond}`)] : []),
  ];
  const marks: Mark[] = [...drawnRuns.flatMap((run) => run.marks), ...handMarks];
  const lengths = [...commanded, ...drawnRuns.flatMap((run) => run.lengths)];
  const group = make("div", { class: "hero" });
  const view = new AnatomyView(group, anatomy, near, frame, true);
  view.add(
    "Section of the anatomy along the commanded path, with the path of the tool.",
    { lengths, cut },
    marks,
    make(
      "p",
      {},
      "Stroke ",
      ordinal(`/runs/0/strokes/${stroke}`),
      ", cut open along the commanded path.",
      ...(isClosed ? [" The anatomy is hatched."] : []),
      " ",
      make("b", {}, "Red"),
      record.has_convex_tool
        ? " is where the tool touches the surface, or would touch it without a fixture."
        : isClosed
          ? " is where the tip is inside, or would be without a fixture."
          : " is where the tip has passed through the surface, or would have without a fixture.",
    ),
    ...commandedNames.map((name) => make("p", {}, name)),
    ...shownRuns.map((number, place) =>
      make("p", {}, runName(number), make("br"), now[place] as HTMLElement),
    ),
  );
  const time = timeSlider(view, `/runs/0/strokes/${stroke}/tip`, hand.length, (cycle) => {
    for (const { follow } of drawnRuns) follow(cycle);
    const [ball] = handMarks as [Mark];
    ball.place = hand[cycle] ?? ball.place;
    view.placeMarks();
  });
  time.go(moment.cycle);
  group.querySelector("figcaption")?.append(time.element);
  return group;
}
