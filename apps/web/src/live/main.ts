// SPDX-License-Identifier: BSD-3-Clause
/** The page of `keepout live`: puts its parts together. */
import type { GuardSettings, Rule, Vec3 } from "../engine/keepout.ts";
import { ClearanceChart } from "./clearance_chart.ts";
import { CounterexampleView } from "./counterexample_view.ts";
import { HandInput } from "./hand_input.ts";
import {
  element,
  embeddedText,
  grouped,
  made,
  type PageSettings,
  roomBetweenCards,
  save,
  toast,
} from "./page.ts";
import { type PathHeader, parsePath, pathText, replayCommand } from "./path_file.ts";
import { type FromWorker, mostCycles, type Source, type State, type ToWorker } from "./protocol.ts";
import { Readings, showFindings } from "./readings.ts";
import { Scene } from "./scene.ts";

const page: PageSettings = JSON.parse(embeddedText("settings"));
let settings: GuardSettings = {
  rule: page.activation as Rule,
  radius: page.radius,
  toolRadius: page.tool_radius,
  margin: page.margin,
  maxStep: page.max_step,
};
/** An anatomy that can be chosen, and what to call it on a command line. */
interface Choice {
  readonly source: Source;
  readonly command: string;
}
/** By the values of the list's options. */
const choices = new Map<string, Choice>();
let shown: Choice | null = null;
/** That which is being loaded, until it is there or has failed. */
let awaited: Choice | null = null;
let triangles = 0;
let state: State | null = null;
let readings: Readings | null = null;
/** A path that is to be played, once its mesh is there. */
let pendingPath: { header: PathHeader | null; lines: Float64Array } | null = null;

// Work begins before there is anything to draw on.
const worker = new Worker(
  URL.createObjectURL(new Blob([embeddedText("worker")], { type: "text/javascript" })),
);
worker.onmessage = ({ data }: MessageEvent<FromWorker>) => hear(data);
worker.onerror = () => toast("keepout itself has failed in this page: reload it.");

tell({ kind: "start", engine: embeddedText("engine") });
const meshes = element("mesh", HTMLSelectElement);
const grip = element("grip", HTMLElement);
page.meshes.forEach((mesh, i) => {
  const source = { kind: "embedded", mesh, data: embeddedText(`mesh-${i}`) } as const;
  offer("In this page", { source, command: mesh.command_name });
});
chooseMesh();

const view = element("view", HTMLElement);
const scene = made(() => new Scene(view, () => roomBetweenCards(view), placeGrip));
const chart = new ClearanceChart(element("chart", HTMLElement));
const failures = new CounterexampleView();
const input = new HandInput(scene, view, (place) => {
  grip.classList.remove("new");
  tell({ kind: "hand", place });
});

function tell(message: ToWorker): void {
  worker.postMessage(message);
}

function hear(message: FromWorker): void {
  switch (message.kind) {
    case "ready":
      readings = new Readings(message.statuses);
      for (const name of message.shapes) {
        offer("Generated", { source: { kind: "shape", name }, command: name });
      }
      return;
    case "surface":
      input.drop();
      scene.show(message);
      chart.clear();
      state = null;
      shown = awaited;
      if (shown !== null && optionOf(shown) === undefined) offer("Opened", shown);
      selectShown();
      document.title = `${message.name} – keepout live`;
      triangles = message.corners.length / 3;
      return;
    case "findings":
      showFindings(message.findings, triangles, warningsOf(shown));
      return;
    case "guarded":
      awaited = null;
      element("loading", HTMLElement).hidden = true;
      begin();
      play();
      return;
    case "state":
      show(message.state);
      return;
    case "path":
      takePath(message.use, message.lines, message.settings);
      return;
    case "replayed":
      toast(
        message.differs < 0
          ? `Replayed: ${grouped(message.cycles)} cycles, and the tool went the same way, bit for bit.`
          : `Replayed: ${grouped(message.cycles)} cycles; from cycle ${grouped(message.differs + 1)} ` +
              "on the tool went another way than on record.",
      );
      return;
    case "counterexamples":
      failures.open(message);
      return;
    case "settings":
      input.drop();
      settings = message.settings;
      showSettings();
      return;
    case "failure":
      toast(message.message);
      if (message.of !== "load") return;
      awaited = pendingPath = null;
      element("loading", HTMLElement).hidden = true;
      grip.hidden = state === null;
      selectShown();
      return;
  }
}

/** The tool begins beside the anatomy. */
function begin(): void {
  const place = scene.placeBeside(settings.toolRadius + settings.margin);
  tell({ kind: "place", tip: place });
}

function show(now: State): void {
  state = now;
  if (awaited === null && grip.hidden) {
    placeGrip();
    grip.hidden = false;
  }
  input.rest(now.hand);
  scene.update({ hand: now.hand, tip: now.tip, planes: now.planes });
  chart.add(now.time, now.handClearance, now.toolClearance);
  readings?.show(now, settings, scene.frames);
}

/** The ring around the hand, where the view has it. */
function placeGrip(): void {
  if (state !== null) grip.style.transform = scene.shift(state.hand);
}

// What is chosen.

function nameOf({ source }: Choice): string {
  return source.kind === "embedded" ? source.mesh.name : source.name;
}

/** What `keepout live` had to say of it. */
function warningsOf(choice: Choice | null): readonly string[] {
  return choice?.source.kind === "embedded" ? choice.source.mesh.warnings : [];
}

/** The value of its option in the list, if it stands there. */
function optionOf(choice: Choice): string | undefined {
  return [...choices].find(([, one]) => one === choice)?.[0];
}

/** Puts a choice into the list, under a heading. */
function offer(heading: string, choice: Choice): void {
  let group = meshes.querySelector<HTMLOptGroupElement>(`optgroup[label="${heading}"]`);
  if (group === null) {
    group = document.createElement("optgroup");
    group.label = heading;
    meshes.append(group);
  }
  const value = String(choices.size);
  choices.set(value, choice);
  group.append(new Option(nameOf(choice), value));
}

function chooseMesh(): void {
  const choice = choices.get(meshes.value);
  if (choice !== undefined) load(choice);
}

/** The list says what is in the view, also when what was chosen could not be. */
function selectShown(): void {
  if (shown !== null) meshes.value = optionOf(shown) ?? "";
}

function load(choice: Choice): void {
  if (awaited !== null) {
    toast(`${nameOf(awaited)} is still being read`);
    pendingPath = null;
    selectShown();
    return;
  }
  awaited = choice;
  const line = element("loading", HTMLElement);
  line.textContent = `Reading ${nameOf(choice)} …`;
  line.hidden = false;
  grip.hidden = true;
  tell({ kind: "load", source: choice.source, settings });
}

async function openFile(file: File): Promise<void> {
  if (/\.(txt|csv)$/i.test(file.name)) {
    if (awaited !== null) {
      toast(`${nameOf(awaited)} is still being read`);
      return;
    }
    try {
      pendingPath = parsePath(await file.text());
    } catch (error) {
      toast(`${file.name}: ${(error as Error).message}`);
      return;
    }
    adopt(pendingPath.header);
    return;
  }
  pendingPath = null;
  load({
    source: { kind: "file", name: file.name, bytes: new Uint8Array(await file.arrayBuffer()) },
    command: /^[\w.-]+$/.test(file.name) ? file.name : `'${file.name.replaceAll("'", "'\\''")}'`,
  });
}

/** What a path was made with, as far as it is at hand; then plays it. */
function adopt(header: PathHeader | null): void {
  if (header !== null) {
    settings = header.settings;
    showSettings();
    tell({ kind: "settings", settings });
    if (header.mesh !== shown?.command) {
      const choice = [...choices].find(([, { command }]) => command === header.mesh);
      if (choice !== undefined) {
        load(choice[1]); // it is played once that is there
        return;
      }
      pendingPath = null;
      toast(`This path is over ${header.mesh}, which is not in this page: open that file first.`);
      return;
    }
  }
  play();
}

function replay(lines: Float64Array): void {
  input.drop();
  tell({ kind: "replay", lines });
}

/** What was opened, if anything was. */
function play(): void {
  if (pendingPath !== null) replay(pendingPath.lines);
  pendingPath = null;
}

function takePath(use: "save" | "replay", lines: Float64Array, made: GuardSettings): void {
  if (lines.length === 0 || shown === null) return;
  if (use === "replay") {
    replay(lines);
    return;
  }
  const header: PathHeader = { keepout: page.keepout, mesh: shown.command, settings: made };
  const file = `keepout-path-${nameOf(shown).replaceAll(/[^\w.-]/g, "_")}.txt`;
  save(file, pathText(header, lines));
  const isFull = lines.length / 6 >= mostCycles;
  toast(
    `${grouped(lines.length / 6)} cycles saved${isFull ? ", the first ten minutes" : ""}. ` +
      (made.rule === "none"
        ? "Open the file here to see them again."
        : `To do them again outside: ${replayCommand(header, file)}`),
  );
}

// Controls.

const sliders = [
  ["tool-radius", "toolRadius"],
  ["margin", "margin"],
  ["radius", "radius"],
] as const;

function showSettings(): void {
  for (const radio of document.querySelectorAll<HTMLInputElement>("#rules input")) {
    radio.checked = radio.value === settings.rule;
  }
  for (const [id, key] of sliders) {
    const slider = element(id, HTMLInputElement);
    // What the page was made with may be beyond what the slider has.
    slider.min = String(Math.min(Number(slider.min), settings[key]));
    slider.max = String(Math.max(Number(slider.max), settings[key]));
    slider.value = String(settings[key]);
    slider.ariaValueText = `${settings[key]} mm`;
    const output = slider.parentElement?.querySelector("output");
    if (output) output.textContent = `${settings[key]} mm`;
  }
  scene.setToolRadius(settings.toolRadius);
  chart.setMargin(settings.margin);
}

function change(part: Partial<GuardSettings>): void {
  input.drop(); // the tool stands where it is, and so does the hand
  settings = { ...settings, ...part };
  showSettings();
  tell({ kind: "settings", settings });
}

element("rules", HTMLElement).addEventListener("change", (event) => {
  change({ rule: (event.target as HTMLInputElement).value as Rule });
});
for (const [id, key] of sliders) {
  const slider = element(id, HTMLInputElement);
  slider.addEventListener("input", () => change({ [key]: Number(slider.value) }));
}
meshes.addEventListener("change", chooseMesh);
element("open", HTMLButtonElement).onclick = () => element("file", HTMLInputElement).click();
element("again", HTMLButtonElement).onclick = () => {
  input.drop();
  begin();
};
element("file", HTMLInputElement).onchange = ({ target }) => {
  const field = target as HTMLInputElement;
  const file = field.files?.[0];
  if (file) void openFile(file);
  field.value = "";
};
for (const use of ["save", "replay"] as const) {
  element(use, HTMLButtonElement).onclick = () => tell({ kind: "ask for path", use });
}
element("fail", HTMLButtonElement).onclick = () => tell({ kind: "ask for counterexamples" });

// The tool is put where the anatomy is double-clicked.
view.addEventListener("dblclick", (event) => {
  const box = view.getBoundingClientRect();
  const x = (2 * (event.clientX - box.left)) / box.width - 1;
  const y = 1 - (2 * (event.clientY - box.top)) / box.height;
  const place: Vec3 | null = scene.placeBefore(x, y, settings.toolRadius + settings.margin);
  if (place === null) return;
  input.drop();
  tell({ kind: "place", tip: place });
});

// Files that are dropped.
const dropHint = element("drop", HTMLElement);
window.addEventListener("dragover", (event) => {
  event.preventDefault();
  dropHint.hidden = false;
});
window.addEventListener("dragleave", (event) => {
  if (event.relatedTarget === null) dropHint.hidden = true;
});
window.addEventListener("drop", (event) => {
  event.preventDefault();
  dropHint.hidden = true;
  const file = event.dataTransfer?.files[0];
  if (file) void openFile(file);
});
document.addEventListener("visibilitychange", () => {
  tell({ kind: "pause", paused: document.hidden });
});

showSettings();
