// SPDX-License-Identifier: BSD-3-Clause
/** The page of `keepout live`, for the ball of a tip or for an instrument: connects its parts. */
import type {
  Findings,
  Frame,
  Rule,
  StatusWords,
  ToolFacts,
  ToolSettings,
  Vec3,
} from "../engine/keepout.ts";
import { colorOf } from "../page/color_of.ts";
import { grouped, saveFile } from "../page/elements.ts";
import { tissueOf, tissues } from "../page/tissue.ts";
import { anatomyWords } from "./anatomy_words.ts";
import { ClearanceChart } from "./clearance_chart.ts";
import { type Course, Demonstration } from "./demonstration.ts";
import { takeFiles } from "./file_input.ts";
import { showFindings } from "./findings.ts";
import { type GuideKind, GuidePanel } from "./guide_panel.ts";
import { HandInput } from "./hand_input.ts";
import { type Choice, MeshList, meshOf, nameOf } from "./mesh_list.ts";
import {
  element,
  embeddedText,
  isTip,
  made,
  page,
  reportGraphics,
  roomBetweenCards,
  set,
  toast,
} from "./page.ts";
import { type PathHeader, parsePath, pathText, replayCommand } from "./path_file.ts";
import { tenMinutes } from "./path_record.ts";
import { type FromWorker, type Handlers, handled, type State, type ToWorker } from "./protocol.ts";
import { Readings } from "./readings.ts";
import { addRobotControls } from "./robot_controls.ts";
import { firstPositions, parseRobotPath, robotPathText } from "./robot_path.ts";
import { RobotScene } from "./robot_scene.ts";
import { makeWorker } from "./second_engine.ts";
import { SettingsPanel } from "./settings_panel.ts";
import { SideBySide } from "./side_by_side.ts";
import type { StartLine } from "./start_place.ts";
import { ToolScene } from "./tool_scene.ts";
import { addViewKeys } from "./view_keys.ts";

/** The largest initial tool radius, as a fraction of the anatomy's diagonal. */
const largestTool = 0.03;
/** Below this extent a mesh may be in meters: MeshFindings::meters_below. [mm] */
const metersBelow = 3;
/** The rules of the keys 1, 2, 3 and 4. */
const rules: readonly Rule[] = isTip
  ? ["none", "all_faces", "paper", "certified"]
  : ["none", "tip_only", "certified"];

// The page has the elements for both tools.
for (const part of document.querySelectorAll<HTMLElement>("[data-tool]")) {
  if ((part.dataset.tool === "tip") === isTip) part.removeAttribute("data-tool");
  else part.remove();
}

let settings: ToolSettings = {
  rule: page.activation as Rule,
  radius: page.radius,
  toolRadius: page.tool_radius,
  margin: page.margin,
  maxStep: page.max_step,
  guides: page.guides,
  ...(isTip ? {} : { opening: 30 }),
};
/** The tool radius that the command or the user has chosen. [mm] */
let chosenRadius = settings.toolRadius;
let shown: Choice | null = null;
/** The choice that is loading, until it is loaded or has failed. */
let awaited: Choice | null = null;
let triangles = 0;
let facts: ToolFacts | null = null;
let state: State | null = null;
let readings: Readings | null = null;
/** The mode with two scenes; null for an instrument. */
let sideBySide: SideBySide | null = null;
let statusWords: readonly StatusWords[] = [];
/** A path to replay once its mesh is loaded. */
let pendingPath: { header: PathHeader | null; lines: Float64Array } | null = null;
/** The port of an instrument: that of the page, or that of an opened path. */
let portBase: readonly number[] | null = null;

// The worker starts before the scene exists.
const worker = makeWorker();
/** Computes the shading of the anatomy beside the control loop. */
let shader: Worker | null = null;
worker.onmessage = ({ data }: MessageEvent<FromWorker>) => handled(handlers, data);
worker.onerror = () => toast("keepout itself has failed in this page: reload it.");

const subject = isTip ? "tip" : "instrument";
tell({ kind: "start", engine: embeddedText("engine"), subject });
const meshes = new MeshList(load);
const grip = element("grip", HTMLElement);
/** The hand in the other pane of the mode with two scenes. */
const otherGrip = grip.cloneNode() as HTMLElement;
otherGrip.id = "other-grip";
grip.after(otherGrip);
page.meshes.forEach((mesh, i) => {
  const source = { kind: "embedded", mesh, data: embeddedText(`mesh-${i}`) } as const;
  meshes.offer("In this page", { source, command: mesh.command_name });
});
meshes.choose();

const view = element("view", HTMLElement);
const room = () => roomBetweenCards(view);
const robotScene = isTip ? null : made(() => new RobotScene(view, room, placeGrip));
const scene = robotScene ?? made(() => new ToolScene(view, room, placeGrip, true));
reportGraphics(element("picture", HTMLCanvasElement));
const find = element("find", HTMLButtonElement);
find.onclick = () => state !== null && scene.lookAt(state.hand.place);
const chart = new ClearanceChart(element("chart", HTMLElement));
const input = new HandInput(scene, view, !isTip, (hand) => {
  grip.classList.remove("new");
  tell({ kind: "hand", hand });
});

addViewKeys(view, scene.motion);

function tell(message: ToWorker, transfer: Transferable[] = []): void {
  worker.postMessage(message, transfer);
}

const handlers: Handlers<FromWorker> = {
  ready({ statuses, shapes }) {
    readings = new Readings(statuses);
    statusWords = statuses;
    // A generated mesh has no port for an instrument.
    for (const name of isTip ? shapes : []) {
      meshes.offer("Generated", { source: { kind: "shape", name }, command: name });
    }
  },
  surface(surface) {
    input.drop();
    showSurface(surface);
    chart.clear();
    state = null;
    shown = awaited;
    if (shown !== null) meshes.select(shown);
    document.title = `${surface.name} – keepout live`;
    set("hint", `drag me into ${anatomyWords(surface.name).surface}`);
    triangles = surface.corners.length / 3;
    readings?.name(surface.name);
    if (isTip && pendingPath === null) fitTool();
  },
  shaded({ shading }) {
    scene.refine(shading);
    shader?.terminate();
    shader = null;
  },
  findings({ findings }) {
    showFindings(findings, triangles, meshOf(shown)?.warnings ?? []);
    offerMeters(findings);
  },
  guarded() {
    endLoading();
    begin();
    play();
    sideBySide?.loaded();
  },
  tool(tool) {
    facts = tool.facts;
    scene.equip(facts);
  },
  state: (message) => show(message.state),
  path: ({ use, lines, settings: madeWith }) => takePath(use, lines, madeWith),
  replayed({ cycles, differs }) {
    if (sideBySide?.ended()) return;
    const what = isTip ? "the tool" : "the joints";
    toast(
      differs < 0
        ? `Replayed: ${grouped(cycles)} cycles, and ${what} went the same way, bit for bit.`
        : `Replayed: ${grouped(cycles)} cycles; from cycle ${grouped(differs + 1)} ` +
            `on ${what} went another way than on record.`,
    );
  },
  counterexamples: (message) => sideBySide?.openTrials(message),
  settings(message) {
    settings = message.settings;
    showSettings();
  },
  failure({ message, of }) {
    toast(message);
    if (of !== "load") return;
    endLoading();
    pendingPath = null;
    grip.hidden = state === null;
    meshes.select(shown);
  },
};

/** Shows an anatomy at once; another worker computes how it takes the light. */
function showSurface(surface: Parameters<Handlers<FromWorker>["surface"]>[0]): void {
  const isShape = awaited?.source.kind === "shape";
  const tissue = isShape ? tissues.shape : tissueOf(surface.name);
  scene.show(surface, tissue);
  shader?.terminate();
  shader = makeWorker();
  shader.onmessage = ({ data }: MessageEvent<FromWorker>) => handled(handlers, data);
  const { positions, corners } = surface;
  const message: ToWorker = { kind: "shade", positions, corners, creases: tissue.creases };
  shader.postMessage(message);
}

function endLoading(): void {
  awaited = null;
  element("loading", HTMLElement).hidden = true;
}

/** Places an instrument where the command has placed it, and a tip beside the anatomy. */
function begin(): void {
  const start = meshOf(shown)?.start;
  const isOpened = start?.base.join() !== portBase?.join();
  if (isOpened && pendingPath !== null && facts !== null) {
    tell({ kind: "place", positions: firstPositions(pendingPath.lines, facts) });
  } else if (start !== undefined) tell({ kind: "place", positions: start.positions });
  else startOn(scene.linesBeside());
}

/** Places a tip on one of these lines, at its usual distance from the anatomy. */
function startOn(lines: readonly StartLine[]): void {
  const least = settings.toolRadius + settings.margin;
  tell({ kind: "place on a line", lines, wanted: least + scene.beginning(), least });
}

/** Makes the tool small beside a small anatomy; else as large as the user has chosen. */
function fitTool(): void {
  const most = Number((largestTool * scene.diagonal).toPrecision(1));
  const toolRadius = Math.min(chosenRadius, most);
  if (toolRadius === settings.toolRadius) return;
  settings = { ...settings, toolRadius };
  showSettings();
  tell({ kind: "settings", settings });
}

/** Offers to scale an opened mesh that seems to be in meters. */
function offerMeters({ size }: Findings): void {
  const source = shown?.source;
  const extent = Math.max(...size);
  if (shown === null || source?.kind !== "file" || source.scale !== 1) return;
  if (extent >= metersBelow || extent < metersBelow / 1000) return;
  const { command } = shown;
  const act = () =>
    load({
      source: { ...source, name: `${source.name} × 1000`, scale: 1000 },
      command: `${command} --scale 1000`,
    });
  const text = `This mesh is ${Number(extent.toPrecision(2))} mm across. Is it in meters?`;
  toast(text, { name: "Scale by 1000", act });
}

function show(now: State): void {
  if (facts === null) return;
  state = now;
  if (awaited === null && grip.hidden) {
    placeGrip();
    grip.hidden = false;
  }
  demonstrate(now);
  input.rest(now.hand);
  scene.update(now);
  chart.add(now.time, now.handClearance, Math.min(...now.clearances));
  readings?.show(now, settings, facts, scene.frames);
  sideBySide?.show(now, statusWords);
}

// The first seconds.

/** "due" until the first tool is placed; "over" after its demonstration, or if the visitor does not want it. */
let demonstration: Demonstration | "due" | "over" = matchMedia("(prefers-reduced-motion: reduce)")
  .matches
  ? "over"
  : "due";
const lesson = element("lesson", HTMLElement);
for (const kind of ["pointerdown", "keydown", "wheel", "drop"]) {
  document.addEventListener(kind, endDemonstration, { capture: true, passive: true });
}

function demonstrate(now: State): void {
  if (demonstration === "over" || awaited !== null) return;
  if (demonstration === "due") {
    const hold = (hand: Frame | null) => tell({ kind: "hand", hand });
    demonstration = new Demonstration(now.hand, courseOf(now), hold, showLesson);
    grip.classList.remove("new");
  }
  if (!demonstration.advance(now)) demonstration = "over";
}

/** Returns the motion of the hand: a tip moves to the nearest surface, an instrument along its shaft. */
function courseOf({ flange, cores, clearances }: State): Course {
  const back = cores.slice(0, 3).map((value, i) => value - (flange.place[i] as number));
  const length = Math.hypot(...back);
  const along = back.map((value) => -value / length) as unknown as Vec3;
  const most = 0.06 * scene.diagonal;
  return {
    ...(isTip
      ? scene.ontoSurface(flange.place)
      : { towards: along, across: scene.across(1, 0, 0) }),
    distance: Math.max(2 * Math.min(...clearances), 10),
    depth: Math.min(6, most),
    width: Math.min(10, most),
  };
}

function showLesson(phase: Parameters<ConstructorParameters<typeof Demonstration>[3]>[0]): void {
  const word = anatomyWords(shown === null ? "" : nameOf(shown)).surface;
  const words = {
    approach: "The hand (red) moves, and the tool follows it.",
    press: `The hand goes into ${word}. The tool stops ${settings.margin} mm before it.`,
    slide: "The tool slides along the surface.",
    back: "Now the hand moves back.",
  };
  const yours = isTip ? `drag the red ring into ${word}.` : "drag the jaws.";
  set(lesson, phase === null ? `Your turn: ${yours}` : words[phase]);
  lesson.hidden = false;
  if (phase === null) grip.classList.add("new");
}

/** The visitor takes over. */
function endDemonstration(): void {
  if (demonstration instanceof Demonstration) demonstration.end(false);
  demonstration = "over";
  lesson.hidden = true;
}

/** Puts the ring around the hand. */
function placeGrip(): void {
  if (state === null) return;
  const { place } = state.hand;
  grip.style.transform = scene.shift(place);
  otherGrip.style.transform = scene.shift(place, 0);
  otherGrip.hidden = grip.hidden;
  const at = scene.project(place);
  const open = scene.openView();
  find.hidden = grip.hidden || (at.z < 1 && Math.abs(at.x) <= open.x + 0.02 && Math.abs(at.y) <= 1);
}

// Settings.

/** True while another mesh is being read; then shows a message to the user. */
function isReading(): boolean {
  if (awaited !== null) toast(`${nameOf(awaited)} is still being read`);
  return awaited !== null;
}

function load(choice: Choice): void {
  if (isReading()) {
    pendingPath = null;
    meshes.select(shown);
    return;
  }
  awaited = choice;
  const line = element("loading", HTMLElement);
  line.textContent = `Reading ${nameOf(choice)} …`;
  line.hidden = false;
  grip.hidden = true;
  if (shown !== null && pendingPath === null) {
    settings = { ...settings, guides: guides.forAnother(settings.guides) };
    showSettings();
  }
  portBase = pendingPath?.header?.base ?? meshOf(choice)?.start?.base ?? null;
  const port = page.robot !== undefined && portBase ? { robot: page.robot, base: portBase } : null;
  tell({ kind: "load", source: choice.source, settings, port });
  sideBySide?.loading(choice);
}

async function openFile(file: File): Promise<void> {
  if (/\.(txt|csv)$/i.test(file.name)) {
    if (isReading()) return;
    try {
      const text = await file.text();
      pendingPath = isTip ? parsePath(text) : parseRobotPath(text, settings);
    } catch (error) {
      toast(`${file.name}: ${(error as Error).message}`);
      return;
    }
    adopt(pendingPath.header);
    return;
  }
  pendingPath = null;
  if (!isTip) {
    toast("An instrument needs a port, which the command places: keepout live MESH --robot psm.");
    return;
  }
  load({
    source: {
      kind: "file",
      name: file.name,
      bytes: new Uint8Array(await file.arrayBuffer()),
      scale: 1,
    },
    command: /^[\w.-]+$/.test(file.name) ? file.name : `'${file.name.replaceAll("'", "'\\''")}'`,
  });
}

/**
 * Applies the settings that a path was recorded with, as far as they are available; then replays
 * it.
 */
function adopt(header: PathHeader | null): void {
  if (header !== null) {
    const choice = header.mesh === shown?.command ? shown : meshes.called(header.mesh);
    const isOther = header.base !== undefined && meshOf(choice ?? null)?.digest !== header.digest;
    if (choice === undefined || choice === null || isOther) {
      pendingPath = null;
      const place = isTip ? "open that file first" : "make a page with it";
      toast(`This path is over ${header.mesh}, which is not in this page: ${place}.`);
      return;
    }
    settings = header.settings;
    showSettings();
    tell({ kind: "settings", settings });
    if (choice !== shown || header.base?.join() !== portBase?.join()) {
      load(choice); // it is replayed after loading
      return;
    }
  }
  play();
}

function replay(lines: Float64Array): void {
  input.drop();
  tell({ kind: "replay", lines, isHeld: false });
}

/** Replays the opened path, if there is one. */
function play(): void {
  if (pendingPath !== null) replay(pendingPath.lines);
  pendingPath = null;
}

function takePath(use: "save" | "replay", lines: Float64Array, madeWith: ToolSettings): void {
  if (lines.length === 0 || shown === null || facts === null) return;
  if (use === "replay") {
    replay(lines);
    return;
  }
  const { keepout, robot } = page;
  const both = sideBySide?.isOn ? `-${madeWith.rule}` : "";
  const name = nameOf(shown).replaceAll(/[^\w.-]/g, "_") + both;
  const mesh = meshOf(shown);
  if (robot !== undefined && mesh !== undefined && portBase !== null) {
    const text = robotPathText({ keepout, robot }, madeWith, mesh, portBase, facts, lines);
    saveFile(`keepout-path-${robot}-${name}.txt`, text, "text/plain");
    toast(`${grouped(lines.length / (2 * facts.positions + 6))} cycles saved.`);
    return;
  }
  const header: PathHeader = { keepout, mesh: shown.command, settings: madeWith };
  const file = `keepout-path-${name}.txt`;
  saveFile(file, pathText(header, lines), "text/plain");
  const isFull = lines.length / 6 >= tenMinutes;
  toast(
    `${grouped(lines.length / 6)} cycles saved${isFull ? ", the first ten minutes" : ""}. ` +
      (madeWith.rule === "none"
        ? "Open the file here to see them again."
        : `To do them again outside: ${replayCommand(header, file)}`),
  );
}

// Controls.

const panel = new SettingsPanel(change);
const guides = new GuidePanel(fittedGuide, change);

/** Returns the text of a guide of a kind for the tip, or for the jaw's end; null without a tool. */
function fittedGuide(kind: GuideKind): string | null {
  if (state === null || facts === null) return null;
  const region = scene.regionAbout(state.flange.place, kind);
  return isTip ? region : `${kind}=point:${facts.link}:${facts.end.join()}:${region}`;
}

function showSettings(): void {
  panel.show(settings);
  guides.show(settings);
  chart.setMargin(settings.margin);
  scene.setMargin(settings.margin, settings.rule !== "none");
  showColors();
}

/** Shows the tool in the color of its rule. */
function showColors(): void {
  document.documentElement.style.setProperty("--tool", `var(--rule-${settings.rule})`);
  scene.paintTool(colorOf("--tool"));
  sideBySide?.paint();
}

function change(part: Partial<ToolSettings>): void {
  chosenRadius = part.toolRadius ?? chosenRadius;
  settings = { ...settings, ...part };
  showSettings();
  tell({ kind: "settings", settings });
}

element("again", HTMLButtonElement).onclick = () => {
  input.drop();
  const base = meshOf(shown)?.start?.base;
  if (base !== undefined && base.join() !== portBase?.join() && shown !== null) load(shown);
  else begin();
};
element("out", HTMLButtonElement).onclick = () => element("again", HTMLButtonElement).click();
for (const use of ["save", "replay"] as const) {
  element(use, HTMLButtonElement).onclick = () => tell({ kind: "ask for path", use });
}
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", showColors);
document.addEventListener("visibilitychange", () => {
  tell({ kind: "pause", paused: document.hidden || sideBySide?.isStill === true });
});
takeFiles((file) => void openFile(file));
// The keys choose a rule, also while the pointer drags the hand.
document.addEventListener("keydown", (event) => {
  const isTyping = event.target instanceof HTMLInputElement && event.target.type === "text";
  const rule = rules[Number(event.key) - 1];
  if (rule === undefined || isTyping || event.altKey || event.ctrlKey || event.metaKey) return;
  if (sideBySide?.isOn) sideBySide.chooseRule(rule);
  else change({ rule });
});
if (robotScene !== null) {
  addRobotControls(robotScene);
  view.ariaLabel =
    "The anatomy and the instrument, with the hand in red. Arrow keys lead its jaw across the view, " +
    "Page Up and Page Down into it and out of it; A, D, W, S, Q and E turn it; with Shift slowly; " +
    "Escape releases it. I, J, K and L turn the view, plus and minus zoom.";
}
sideBySide = isTip ? addTipControls() : null;
showSettings();

/** Adds double-clicks and the mode with two scenes, which the page of an instrument does not have. */
function addTipControls(): SideBySide {
  const two = new SideBySide({
    scene,
    tell,
    change,
    load,
    settings: () => settings,
    drop: () => input.drop(),
    shown: () => shown,
    isLoading: () => awaited !== null,
    sample: (name) => meshes.sample(name),
    savePath: (lines, madeWith) => takePath("save", lines, madeWith),
  });
  element("fail", HTMLButtonElement).onclick = () => two.showTrials();

  // A double-click on the anatomy places the tool there.
  view.addEventListener("dblclick", (event) => {
    const { x, y } = input.inView(event);
    const line = scene.lineBefore(x, y);
    if (line === null) return;
    input.drop();
    startOn([line]);
  });

  return two;
}
