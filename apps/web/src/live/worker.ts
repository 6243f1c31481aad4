// SPDX-License-Identifier: BSD-3-Clause
/**
 * Where keepout runs: apart from the page, so that cycles do not wait for drawing. Browsers wake a
 * worker every few milliseconds at best; each time, all cycles that are due are run.
 */
import makeModule from "keepout-module";
import { type Anatomy, type GuardSettings, Keepout, type Vec3 } from "../engine/keepout.ts";
import { decodeSurface } from "../page/embedded_surface.ts";
import { unpacked } from "../page/unpacked.ts";
import { ControlLoop } from "./control_loop.ts";
import { runCounterexamples } from "./counterexample_trials.ts";
import type { FromWorker, Source, ToWorker } from "./protocol.ts";

/** Cycles that are due and no more caught up with. */
const mostBehind = 100;
/** Between two words to the page. [ms] */
const tellEvery = 15;

let keepout: Keepout;
let anatomy: { of: Anatomy; settings: GuardSettings } | null = null;
let loop: ControlLoop | null = null;
let accepted: GuardSettings | null = null; // those that a guard was last made with
let place: Vec3 | null = null; // where the tool was put last, in this anatomy
let paused = false;

let begun = 0; // the page's clock at cycle 0 [ms]
let done = 0; // cycles since, run or lost
let lost = 0;
let told = 0; // when the page was last told [ms]
/** Over the last second: when a second began, how many cycles it had, and how long they took. */
const second = { begin: 0, cycles: 0, busy: 0, rate: 0, stepTime: 0 };

function tell(message: FromWorker, transfer: Transferable[] = []): void {
  self.postMessage(message, { transfer });
}

/** The clock starts anew: nothing is due. */
function restartClock(): void {
  begun = performance.now();
  done = 0;
  Object.assign(second, { begin: begun, cycles: 0, busy: 0 });
}

function run(): void {
  if (loop === null || paused) return;
  const now = performance.now();
  let due = Math.floor(now - begun) - done;
  if (due > mostBehind) {
    lost += due - mostBehind;
    done += due - mostBehind;
    due = mostBehind;
  }
  for (; due > 0; --due, ++done, ++second.cycles) {
    const end = loop.run();
    if (end !== null) tell({ kind: "replayed", ...end });
  }
  const after = performance.now();
  second.busy += after - now;
  if (after - second.begin >= 1000) {
    second.rate = (1000 * second.cycles) / (after - second.begin);
    second.stepTime = (1000 * second.busy) / Math.max(second.cycles, 1);
    Object.assign(second, { begin: after, cycles: 0, busy: 0 });
  }
  if (after - told >= tellEvery) {
    told = after;
    tellState(after);
  }
}

function tellState(time: number): void {
  const last = loop?.last;
  if (!loop || !last) return;
  tell({
    kind: "state",
    state: {
      time,
      tip: loop.tip,
      hand: loop.hand,
      force: last.force,
      status: last.status,
      planes: loop.activePlanes().map(({ normal, offset, triangle }) => ({
        normal,
        // From where the tool is now, no more from where it was before the cycle.
        offset: offset - normal.reduce((sum, n, i) => sum + n * (last.motion[i] as number), 0),
        triangle,
      })),
      planeCount: last.planeCount,
      triangles: last.triangles,
      toolClearance: loop.anatomy.clearance(loop.tip) - loop.settings.toolRadius,
      handClearance: loop.anatomy.clearance(loop.hand) - loop.settings.toolRadius,
      cycles: loop.cycles,
      limited: loop.limited,
      lost,
      stepTime: second.stepTime,
      rate: second.rate,
    },
  });
}

function tellSurface(name: string, vertices: Float64Array, corners: Uint32Array): void {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < vertices.length; ++i) {
    const value = vertices[i] as number;
    const axis = i % 3;
    if (value < (low[axis] as number)) low[axis] = value;
    if (value > (high[axis] as number)) high[axis] = value;
  }
  const origin = low.map((value, i) => 0.5 * (value + (high[i] as number))) as unknown as Vec3;
  // What is drawn are floats: of coordinates from the middle on, which are small.
  const positions = Float32Array.from(vertices, (value, i) => value - (origin[i % 3] as number));
  const copied = corners.slice();
  tell({ kind: "surface", name, origin, positions, corners: copied }, [
    positions.buffer,
    copied.buffer,
  ]);
}

/** No anatomy, and nothing that guards it. */
function letGo(): void {
  loop?.discard();
  anatomy?.of.discard();
  loop = anatomy = place = null;
}

async function load(source: Source, settings: GuardSettings): Promise<void> {
  const name = source.kind === "embedded" ? source.mesh.name : source.name;
  let made: Anatomy;
  if (source.kind === "embedded") {
    const { vertices, corners } = await decodeSurface(source.mesh, source.data);
    letGo(); // what is seen from here on is the other one
    tellSurface(name, vertices, corners);
    made = keepout.anatomyOfSurface(vertices, corners);
  } else {
    made =
      source.kind === "shape"
        ? keepout.anatomyOfShape(source.name)
        : keepout.anatomyOfFile(source.name, source.bytes);
    tellSurface(name, made.vertices, made.corners);
  }
  letGo();
  anatomy = { of: made, settings };
  lost = 0;
  tell({ kind: "findings", findings: made.findings() });
  tell({ kind: "guarded" });
}

async function start(engine: string): Promise<void> {
  keepout = await Keepout.load(makeModule, new Uint8Array(await unpacked(engine)));
  const statuses = [];
  for (let i = 0; keepout.statusName(i) !== "unknown"; ++i) {
    statuses.push({ name: keepout.statusName(i), reason: keepout.statusReason(i) });
  }
  tell({ kind: "ready", shapes: keepout.shapes, statuses });
  setInterval(run, 1);
}

/** Begins where the tool was put, if it has not yet; what the engine refuses is thrown. */
function begin(): void {
  if (loop !== null || anatomy === null || place === null) return;
  try {
    loop = new ControlLoop(keepout, anatomy.of, anatomy.settings, place);
  } catch (error) {
    if (accepted === null) throw error;
    anatomy.settings = accepted;
    tell({ kind: "settings", settings: accepted });
    loop = new ControlLoop(keepout, anatomy.of, accepted, place);
    throw error;
  } finally {
    restartClock();
  }
  accepted = anatomy.settings;
}

function handle(message: ToWorker): void | Promise<void> {
  switch (message.kind) {
    case "start":
      return start(message.engine);
    case "load":
      return load(message.source, message.settings);
    case "settings":
      if (loop !== null) {
        loop.use(message.settings);
        accepted = message.settings;
      }
      if (anatomy !== null) anatomy.settings = message.settings;
      begin();
      return;
    case "place":
      place = message.tip;
      loop?.place(place);
      begin();
      return;
    case "hand":
      loop?.hold(message.place);
      return;
    case "replay":
      loop?.startReplay(message.lines);
      return;
    case "ask for path":
      if (loop !== null) {
        tell({
          kind: "path",
          use: message.use,
          lines: loop.record.lines(),
          settings: loop.settings,
        });
      }
      return;
    case "ask for counterexamples":
      tell({ kind: "counterexamples", ...runCounterexamples(keepout) });
      restartClock();
      return;
    case "pause":
      paused = message.paused;
      if (!paused) restartClock();
      return;
  }
}

/** Whether there is an engine: where it could not be loaded, nothing else is tried. */
const isReady = (message: ToWorker): boolean => message.kind === "start" || keepout !== undefined;

/** One after the other: a message waits until the one before is done with. */
let queue: Promise<void> = Promise.resolve();
self.onmessage = ({ data }: MessageEvent<ToWorker>) => {
  queue = queue
    .then(() => (isReady(data) ? handle(data) : undefined))
    .catch((error: unknown) => {
      tell({
        kind: "failure",
        of: data.kind,
        message: error instanceof Error ? error.message : String(error),
      });
      if (data.kind === "settings" && anatomy !== null) {
        tell({ kind: "settings", settings: anatomy.settings });
      }
      restartClock();
    });
};
