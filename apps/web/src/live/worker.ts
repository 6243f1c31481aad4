// SPDX-License-Identifier: BSD-3-Clause
/** The worker that runs keepout, so that cycles do not wait for drawing. */
import makeModule from "keepout-module";
import {
  type Anatomy,
  type Keepout,
  loadKeepout,
  type Port,
  type Subject,
  Tool,
  type ToolSettings,
} from "../engine/keepout.ts";
import { centered } from "../page/centered_surface.ts";
import { decodeSurface, unpacked } from "../page/embedded_surface.ts";
import { shade } from "../page/shading.ts";
import { ControlLoop } from "./control_loop.ts";
import { runCounterexamples } from "./counterexample_trials.ts";
import { CycleClock } from "./cycle_clock.ts";
import { follow, Leader } from "./lockstep.ts";
import { type FromWorker, type Handlers, handled, type Source, type ToWorker } from "./protocol.ts";
import { SurroundingsFinder } from "./robot_surroundings.ts";
import { startPlace } from "./start_place.ts";
import { crossing } from "./wall.ts";

let keepout: Keepout;
let anatomy: { of: Anatomy; settings: ToolSettings; port: Port | null } | null = null;
let surroundings: SurroundingsFinder | null = null; // of an instrument
let loop: ControlLoop | null = null;
let accepted: ToolSettings | null = null; // the settings of the last tool
let place: readonly number[] | null = null; // the last start of the tool, in this anatomy
const clock = new CycleClock();
/** The accuracy of a clearance near the margin. [mm] */
const accuracy = 0.05;
let leader: Leader | null = null;
let isFollower = false;

function tell(message: FromWorker, transfer: Transferable[] = []): void {
  self.postMessage(message, { transfer });
}

function run(): void {
  if (loop === null || isFollower || leader?.isAhead) return;
  const control = loop;
  const at = clock.run(() => {
    const end = control.run();
    leader?.add(control);
    if (end !== null) tell({ kind: "replayed", ...end });
  });
  if (at !== null) tellState(at);
  leader?.flush(at);
}

function tellState(time: number): void {
  if (loop === null || anatomy === null) return;
  const { last, hand, tool, cycles, limited, placed, crossings, crossedAt } = loop;
  const { bodies } = tool.facts;
  const clearances = bodies.map((_, i) => tool.made.clearance(i));
  // The engine's own distance of the nearest body, if known. A negative one is not the depth, because it ends
  // where the axis of the body meets the surface.
  if (last.nearest >= 0 && last.distance > 0) clearances[last.nearest] = last.distance;
  const around = surroundings?.find(tool, last, hand, clearances) ?? null;
  const away = anatomy.of.clearance(...hand.place) - (bodies.at(-1)?.radius ?? 0);
  const handClearance = around?.isHandBehind ? -Math.abs(away) : away;
  const planes = tool.made.planes().filter(({ isActive }) => isActive);
  const { lost, stepTime, rate } = clock;
  const state = { ...last, time, hand, clearances, handClearance, planes, surroundings: around };
  tell({
    kind: "state",
    state: { ...state, cycles, limited, placed, crossings, crossedAt, lost, stepTime, rate },
  });
}

/** Sends a surface to be drawn. Returns the diagonal of its box. [mm] */
function tellSurface(
  name: string,
  surface: { vertices: Float64Array; corners: Uint32Array },
): number {
  const drawn = centered(surface.vertices, surface.corners);
  tell({ kind: "surface", name, ...drawn }, [drawn.positions.buffer, drawn.corners.buffer]);
  return drawn.size;
}

/** Makes a tool on the anatomy. Throws if the engine rejects the settings. */
function makeTool(settings: ToolSettings): Tool {
  const { of, port } = anatomy as NonNullable<typeof anatomy>;
  const tool = new Tool(keepout, of, settings, port);
  tell({ kind: "tool", facts: tool.facts });
  return tool;
}

/** Throws if the jaws of an instrument cannot open so far where they are. */
function requireRoom(settings: ToolSettings, { last }: ControlLoop): void {
  if (settings.rule !== "certified" || anatomy === null) return;
  const tool = new Tool(keepout, anatomy.of, settings, anatomy.port);
  tool.place(last.positions);
  const least = Math.min(...tool.facts.bodies.map((_, i) => tool.made.clearance(i)));
  tool.made.delete();
  if (least < settings.margin - accuracy) {
    throw new Error("There is no room here to open the jaws: move them back first.");
  }
}

/** Deletes the anatomy and the tool. */
function letGo(): void {
  loop?.discard();
  anatomy?.of.delete();
  loop = anatomy = place = null;
  stopLeading();
}

async function load(source: Source, settings: ToolSettings, port: Port | null): Promise<void> {
  const name = source.kind === "embedded" ? source.mesh.name : source.name;
  let made: Anatomy;
  let size: number;
  if (source.kind === "embedded") {
    const surface = await decodeSurface(source.mesh, source.data);
    letGo(); // from here on the page shows the other one
    size = tellSurface(name, surface);
    made = keepout.anatomyOfSurface(surface.vertices, surface.corners);
  } else {
    made =
      source.kind === "shape"
        ? keepout.anatomyOfShape(source.name)
        : scaled(keepout.anatomyOfFile(fileOf(source.name), source.bytes), source.scale);
    size = tellSurface(name, made.surface());
  }
  letGo();
  anatomy = { of: made, settings, port };
  surroundings = port === null ? null : new SurroundingsFinder(made, size);
  clock.lost = 0;
  tell({ kind: "findings", findings: made.findings() });
  tell({ kind: "guarded" });
}

/** Returns the name of a file without its factor: the engine needs the extension. */
const fileOf = (name: string): string => name.replace(/ × \d+$/, "");

/** Returns an anatomy with all coordinates multiplied; deletes the given one if it makes another. */
function scaled(made: Anatomy, scale: number): Anatomy {
  if (scale === 1) return made;
  const { vertices, corners } = made.surface();
  const larger = Float64Array.from(vertices, (value) => scale * value);
  const copied = corners.slice();
  made.delete();
  return keepout.anatomyOfSurface(larger, copied);
}

/** Places tip or joints, and starts the tool if it has not started. */
function placeAt(positions: readonly number[]): void {
  place = positions;
  loop?.place(place);
  begin();
  if (loop !== null) leader?.place(loop);
}

function stopLeading(): void {
  leader?.close();
  leader = null;
  if (loop !== null) loop.isPaired = false;
}

/** Prepares a loop whose cycles another one runs as well. Counts the motions through an open surface. */
function pair(control: ControlLoop): void {
  const { of } = anatomy as NonNullable<typeof anatomy>;
  control.isPaired = true;
  if (of.findings().watertight) return;
  const { vertices, corners } = of.surface();
  const copy = { vertices: vertices.slice(), corners: corners.slice() };
  control.wall = (from, to) => {
    const length = Math.hypot(...to.map((value, axis) => value - (from[axis] as number)));
    return of.clearance(...from) > length ? null : crossing(copy, from, to);
  };
}

async function start(engine: string, subject: Subject): Promise<void> {
  keepout = await loadKeepout(makeModule, new Uint8Array(await unpacked(engine)));
  tell({ kind: "ready", shapes: keepout.shapes(), statuses: keepout.statuses(subject) });
  setInterval(run, 1);
}

/**
 * Starts the tool at its position, if it has not started. Throws if the engine rejects the
 * settings.
 */
function begin(): void {
  if (loop !== null || anatomy === null || place === null) return;
  try {
    loop = new ControlLoop(makeTool, anatomy.settings, place);
  } catch (error) {
    if (accepted === null) throw error;
    anatomy.settings = accepted;
    tell({ kind: "settings", settings: accepted });
    loop = new ControlLoop(makeTool, accepted, place);
    throw error;
  } finally {
    clock.restart();
  }
  accepted = anatomy.settings;
}

const handlers: Handlers<ToWorker> = {
  start: ({ engine, subject }) => start(engine, subject),
  load: ({ source, settings, port }) => load(source, settings, port),
  shade({ positions, corners, creases }) {
    const work = shade(positions, corners, creases);
    let step = work.next();
    while (!step.done) step = work.next();
    const { normals, ambience } = step.value;
    tell({ kind: "shaded", shading: step.value }, [normals.buffer, ambience.buffer]);
  },
  settings({ settings }) {
    if (loop !== null) {
      if ((settings.opening ?? 0) > (loop.settings.opening ?? 0)) requireRoom(settings, loop);
      loop.use(settings);
      accepted = settings;
      leader?.use(settings);
    }
    if (anatomy !== null) anatomy.settings = settings;
    begin();
  },
  place: ({ positions }) => placeAt(positions),
  "place on a line"({ lines, wanted, least }) {
    const { of } = anatomy ?? {};
    if (of === undefined) return;
    const found = startPlace(lines, (...at) => of.clearance(...at), wanted, least);
    if (found === null) throw new Error("there is no room for the tool there");
    placeAt(found);
  },
  hand: ({ hand }) => loop?.hold(hand),
  replay({ lines, isHeld }) {
    loop?.startReplay(lines, isHeld);
    if (loop !== null) leader?.place(loop);
  },
  lead({ port, rule }) {
    stopLeading();
    if (port === null || loop === null) return;
    leader = new Leader(port, rule);
    pair(loop);
    loop.place(loop.last.positions);
    leader.place(loop);
  },
  "rule of the follower"({ rule }) {
    if (loop === null || leader === null) return;
    loop.use(loop.settings); // its path starts anew as well
    leader.use(loop.settings, rule);
  },
  follow({ port }) {
    isFollower = true;
    follow(port, {
      place(positions, settings) {
        if (loop === null) {
          loop = new ControlLoop(makeTool, settings, positions);
          pair(loop);
        } else loop.place(positions);
      },
      use: (settings) => loop?.use(settings),
      loop: () => loop,
      tell: tellState,
      fail(error) {
        const words = error instanceof Error ? error.message : String(error);
        tell({ kind: "failure", of: "settings", message: words });
      },
    });
  },
  "ask for path"({ use }) {
    if (loop === null) return;
    tell({ kind: "path", use, lines: loop.record.lines(), settings: loop.settings });
  },
  "ask for counterexamples"() {
    tell({ kind: "counterexamples", ...runCounterexamples(keepout) });
    clock.restart();
  },
  pause: ({ paused }) => clock.pause(paused),
};

/**
 * Messages are handled one after the other. A failure is reported, and the next message continues.
 */
let queue: Promise<void> = Promise.resolve();
self.onmessage = ({ data: message }: MessageEvent<ToWorker>) => {
  queue = queue
    // Without an engine, only its start and shading are handled.
    .then(() =>
      message.kind === "start" || message.kind === "shade" || keepout
        ? handled(handlers, message)
        : undefined,
    )
    .catch((error: unknown) => {
      const words = error instanceof Error ? error.message : String(error);
      tell({ kind: "failure", of: message.kind, message: words });
      if (message.kind === "settings" && anatomy !== null) {
        tell({ kind: "settings", settings: anatomy.settings });
      }
      clock.restart();
    });
};
