// SPDX-License-Identifier: BSD-3-Clause
/** The page of `keepout live --robot`: puts its parts together. */
import { Quaternion, Vector3 } from "three";
import type { Vec3 } from "../engine/keepout.ts";
import type { Frame, InstrumentFacts } from "../engine/manipulator.ts";
import { ClearanceChart } from "./clearance_chart.ts";
import { HandInput } from "./hand_input.ts";
import { instrumentPathText } from "./instrument_path_file.ts";
import type {
  FromInstrument,
  InstrumentMesh,
  InstrumentPage,
  InstrumentState,
  ToInstrument,
} from "./instrument_protocol.ts";
import { heldBody, InstrumentReadings } from "./instrument_readings.ts";
import { InstrumentScene } from "./instrument_scene.ts";
import { element, embeddedText, grouped, made, roomBetweenCards, save, toast } from "./page.ts";
import { showFindings } from "./readings.ts";

const page: InstrumentPage = JSON.parse(embeddedText("settings"));
let { margin } = page;
let facts: InstrumentFacts | null = null;
let state: InstrumentState | null = null;
let readings: InstrumentReadings | null = null;
let triangles = 0;
/** Whether the view is still to be turned to the instrument. */
let isNew = true;
/** Whether what was chosen is being read. */
let isLoading = false;
/** How the hand is turned. */
let turn = new Quaternion();

const worker = new Worker(
  URL.createObjectURL(new Blob([embeddedText("worker")], { type: "text/javascript" })),
);
worker.onmessage = ({ data }: MessageEvent<FromInstrument>) => hear(data);
worker.onerror = () => toast("keepout itself has failed in this page: reload it.");

tell({ kind: "start", engine: embeddedText("engine"), page });
const meshes = element("mesh", HTMLSelectElement);
const grip = element("grip", HTMLElement);
const slider = element("margin", HTMLInputElement);
page.meshes.forEach(({ name }, i) => {
  meshes.append(new Option(name, String(i)));
});
load();

const view = element("view", HTMLElement);
view.ariaLabel =
  "The anatomy and the instrument, with the hand in red. Arrow keys lead its jaw across the view, " +
  "Page Up and Page Down into it and out of it; A, D, W, S, Q and E turn it; with Shift slowly; " +
  "Escape lets go.";
const scene = made(() => new InstrumentScene(view, () => roomBetweenCards(view), placeGrip));
const chart = new ClearanceChart(element("chart", HTMLElement));
/** Where the hand holds the jaw; null: nowhere. */
let held: Vec3 | null = null;
const input = new HandInput(
  scene,
  view,
  (place) => {
    grip.classList.remove("new");
    if (place !== null && held === null) turn = new Quaternion(...handNow().turn);
    held = place;
    tellHand();
  },
  (rotation) => {
    const about = new Vector3(...rotation);
    const angle = about.length();
    turn.premultiply(new Quaternion().setFromAxisAngle(about.divideScalar(angle), angle));
    tellHand();
  },
);

function tell(message: ToInstrument): void {
  worker.postMessage(message);
}

function tellHand(): void {
  const hand = held === null ? null : { place: held, turn: turn.toArray() as Frame["turn"] };
  tell({ kind: "hand", hand });
}

function handNow(): Frame {
  return state?.hand ?? { place: [0, 0, 0], turn: [0, 0, 0, 1] };
}

function drop(): void {
  input.drop();
  held = null;
}

function mesh(): InstrumentMesh {
  return page.meshes[Number(meshes.value)] as InstrumentMesh;
}

function load(): void {
  const line = element("loading", HTMLElement);
  line.textContent = `Reading ${mesh().name} …`;
  line.hidden = false;
  grip.hidden = isNew = isLoading = meshes.disabled = true;
  const data = embeddedText(`mesh-${meshes.value}`);
  tell({ kind: "load", mesh: mesh(), data, margin });
}

function hear(message: FromInstrument): void {
  switch (message.kind) {
    case "ready":
      readings = new InstrumentReadings(message.statuses);
      return;
    case "surface":
      drop();
      scene.show(message);
      chart.clear();
      state = null;
      document.title = `${message.name} – keepout live`;
      triangles = message.corners.length / 3;
      return;
    case "findings":
      showFindings(message.findings, triangles, mesh().warnings);
      return;
    case "placed":
      facts = message.facts;
      scene.equip(facts);
      endLoading();
      return;
    case "state":
      show(message.state);
      return;
    case "path":
      takePath(message.use, message.lines);
      return;
    case "replayed":
      toast(
        message.differs < 0
          ? `Replayed: ${grouped(message.cycles)} cycles, and the joints went the same way, bit for bit.`
          : `Replayed: ${grouped(message.cycles)} cycles; from cycle ${grouped(message.differs + 1)} ` +
              "on the joints went another way than on record.",
      );
      return;
    case "failure":
      toast(message.message);
      endLoading();
      return;
  }
}

function endLoading(): void {
  element("loading", HTMLElement).hidden = true;
  isLoading = meshes.disabled = false;
}

function show(now: InstrumentState): void {
  if (facts === null || isLoading) return;
  state = now;
  const { hand, flange, cores } = now;
  const moment = { hand, flange, cores, held: heldBody(now) };
  if (isNew) scene.lookAtJaw(moment);
  isNew = false;
  input.rest(hand.place);
  scene.update(moment);
  placeGrip();
  grip.hidden = false;
  chart.add(now.time, now.handClearance, Math.min(...now.clearances));
  readings?.show(now, facts, margin, scene.frames);
}

/** The ring around the jaw, where the hand wants it. */
function placeGrip(): void {
  if (state !== null) grip.style.transform = scene.shift(state.hand.place);
}

function takePath(use: "save" | "replay", lines: Float64Array): void {
  if (facts === null || lines.length === 0) return;
  if (use === "replay") {
    drop();
    tell({ kind: "replay", lines });
    return;
  }
  const { keepout, robot, max_step: maxStep } = page;
  const file = `keepout-path-${robot}-${mesh().name.replaceAll(/[^\w.-]/g, "_")}.txt`;
  save(file, instrumentPathText({ keepout, robot, margin, maxStep }, mesh(), facts, lines));
  toast(`${grouped(lines.length / (2 * facts.joints + 6))} cycles saved.`);
}

function showMargin(): void {
  // What the page was made with may be beyond what the slider has.
  slider.min = String(Math.min(Number(slider.min), margin));
  slider.max = String(Math.max(Number(slider.max), margin));
  slider.value = String(margin);
  slider.ariaValueText = `${margin} mm`;
  const output = slider.parentElement?.querySelector("output");
  if (output) output.textContent = `${margin} mm`;
  chart.setMargin(margin);
}

// Controls.

slider.addEventListener("input", () => {
  drop();
  margin = Number(slider.value);
  showMargin();
  tell({ kind: "margin", margin });
});
meshes.addEventListener("change", load);
element("again", HTMLButtonElement).onclick = () => {
  drop();
  tell({ kind: "begin anew" });
};
for (const use of ["save", "replay"] as const) {
  element(use, HTMLButtonElement).onclick = () => tell({ kind: "ask for path", use });
}
document.addEventListener("visibilitychange", () => {
  tell({ kind: "pause", paused: document.hidden });
});

showMargin();
