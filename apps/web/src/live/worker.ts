// SPDX-License-Identifier: BSD-3-Clause
/** Where keepout runs: apart from the page, so that cycles do not wait for drawing. */
import makeModule from "keepout-module";
import { type Anatomy, type GuardSettings, Keepout, type Vec3 } from "../engine/keepout.ts";
import { decodeSurface } from "../page/embedded_surface.ts";
import { unpacked } from "../page/unpacked.ts";
import { ControlLoop } from "./control_loop.ts";
import { runCounterexamples } from "./counterexample_trials.ts";
import { CycleClock } from "./cycle_clock.ts";
import { drawnSurface } from "./drawn_surface.ts";
import { handleInTurn } from "./message_queue.ts";
import type { FromWorker, Source, ToWorker } from "./protocol.ts";

let keepout: Keepout;
let anatomy: { of: Anatomy; settings: GuardSettings } | null = null;
let loop: ControlLoop | null = null;
let accepted: GuardSettings | null = null; // those that a guard was last made with
let place: Vec3 | null = null; // where the tool was put last, in this anatomy
const clock = new CycleClock();

function tell(message: FromWorker, transfer: Transferable[] = []): void {
  self.postMessage(message, { transfer });
}

function run(): void {
  if (loop === null) return;
  const control = loop;
  const at = clock.run(() => {
    const end = control.run();
    if (end !== null) tell({ kind: "replayed", ...end });
  });
  if (at !== null) tellState(at);
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
      lost: clock.lost,
      stepTime: clock.stepTime,
      rate: clock.rate,
    },
  });
}

function tellSurface(name: string, vertices: Float64Array, corners: Uint32Array): void {
  const drawn = drawnSurface(name, vertices, corners);
  tell({ kind: "surface", ...drawn }, [drawn.positions.buffer, drawn.corners.buffer]);
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
  clock.lost = 0;
  tell({ kind: "findings", findings: made.findings() });
  tell({ kind: "guarded" });
}

async function start(engine: string): Promise<void> {
  keepout = await Keepout.load(makeModule, new Uint8Array(await unpacked(engine)));
  tell({ kind: "ready", shapes: keepout.shapes, statuses: keepout.statuses("tip") });
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
    clock.restart();
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
      clock.restart();
      return;
    case "pause":
      clock.pause(message.paused);
      return;
  }
}

/** Whether there is an engine: where it could not be loaded, nothing else is tried. */
const isReady = (message: ToWorker): boolean => message.kind === "start" || keepout !== undefined;

handleInTurn<ToWorker>(
  (message) => (isReady(message) ? handle(message) : undefined),
  (message, words) => {
    tell({ kind: "failure", of: message.kind, message: words });
    if (message.kind === "settings" && anatomy !== null) {
      tell({ kind: "settings", settings: anatomy.settings });
    }
    clock.restart();
  },
);
