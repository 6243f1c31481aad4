// SPDX-License-Identifier: BSD-3-Clause
/** Where keepout runs with an instrument: apart from the page, so that cycles do not wait for drawing. */
import makeModule from "keepout-robot-module";
import { type Anatomy, Keepout } from "../engine/keepout.ts";
import { Manipulator, type RobotModule } from "../engine/manipulator.ts";
import { decodeSurface } from "../page/embedded_surface.ts";
import { unpacked } from "../page/unpacked.ts";
import { CycleClock } from "./cycle_clock.ts";
import { drawnSurface } from "./drawn_surface.ts";
import { InstrumentLoop } from "./instrument_loop.ts";
import type {
  FromInstrument,
  InstrumentMesh,
  InstrumentPage,
  ToInstrument,
} from "./instrument_protocol.ts";
import { handleInTurn } from "./message_queue.ts";

let keepout: Keepout<RobotModule>;
let page: InstrumentPage;
let anatomy: { of: Anatomy; mesh: InstrumentMesh } | null = null;
let loop: InstrumentLoop | null = null;
const clock = new CycleClock();

function tell(message: FromInstrument, transfer: Transferable[] = []): void {
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
  if (loop === null || anatomy === null) return;
  const { last, hand, manipulator, cycles, limited } = loop;
  const { bodies } = manipulator.facts;
  const clearances = bodies.map((_, i) => manipulator.clearance(i));
  // The engine's own figure of the nearest, where it has one.
  if (last.nearest >= 0) clearances[last.nearest] = last.distance;
  tell({
    kind: "state",
    state: {
      time,
      hand,
      flange: last.flange,
      cores: last.cores,
      clearances,
      distance: last.distance,
      nearest: last.nearest,
      handClearance: anatomy.of.clearance(hand.place) - (bodies.at(-1)?.radius ?? 0),
      status: last.status,
      rows: last.rows,
      rounds: last.rounds,
      cycles,
      limited,
      lost: clock.lost,
      stepTime: clock.stepTime,
      rate: clock.rate,
    },
  });
}

/** Another instrument, in place of the one there is: what the engine refuses is thrown. */
function makeLoop(margin: number, positions: readonly number[]): void {
  if (anatomy === null) return;
  const { of, mesh } = anatomy;
  const made = new Manipulator(keepout, of, page.robot, mesh.start, margin);
  const { cycles, limited } = loop ?? { cycles: 0, limited: 0 };
  loop?.discard();
  loop = new InstrumentLoop(made, page.max_step, positions);
  Object.assign(loop, { cycles, limited });
  clock.restart();
  tell({ kind: "placed", facts: made.facts });
}

async function load(mesh: InstrumentMesh, data: string, margin: number): Promise<void> {
  const { vertices, corners } = await decodeSurface(mesh, data);
  loop?.discard();
  anatomy?.of.discard();
  loop = anatomy = null;
  const drawn = drawnSurface(mesh.name, vertices, corners);
  tell({ kind: "surface", ...drawn }, [drawn.positions.buffer, drawn.corners.buffer]);
  anatomy = { of: keepout.anatomyOfSurface(vertices, corners), mesh };
  clock.lost = 0;
  tell({ kind: "findings", findings: anatomy.of.findings() });
  makeLoop(margin, mesh.start.positions);
}

async function handle(message: ToInstrument): Promise<void> {
  switch (message.kind) {
    case "start":
      page = message.page;
      keepout = await Keepout.load(makeModule, new Uint8Array(await unpacked(message.engine)));
      tell({ kind: "ready", statuses: keepout.statuses("instrument") });
      setInterval(run, 1);
      return;
    case "load":
      return load(message.mesh, message.data, message.margin);
    case "margin":
      if (loop !== null) makeLoop(message.margin, loop.last.positions);
      return;
    case "begin anew":
      if (anatomy !== null) loop?.place(anatomy.mesh.start.positions);
      return;
    case "hand":
      loop?.hold(message.hand);
      return;
    case "replay":
      loop?.startReplay(message.lines);
      return;
    case "ask for path":
      if (loop !== null) tell({ kind: "path", use: message.use, lines: loop.record.lines() });
      return;
    case "pause":
      clock.pause(message.paused);
      return;
  }
}

handleInTurn<ToInstrument>(handle, (_message, words) => {
  tell({ kind: "failure", message: words });
  clock.restart();
});
