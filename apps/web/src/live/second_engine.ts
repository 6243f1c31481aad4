// SPDX-License-Identifier: BSD-3-Clause
import type { StatusWords, ToolSettings } from "../engine/keepout.ts";
import { embeddedText } from "./page.ts";
import {
  type FromWorker,
  type Handlers,
  handled,
  type Source,
  type State,
  type ToWorker,
} from "./protocol.ts";

/** Handlers of the page for messages of the second engine. */
export interface SecondEngineEvents {
  /** The anatomy is read: it can follow. */
  readonly ready: () => void;
  readonly state: (state: State, statuses: readonly StatusWords[]) => void;
  readonly path: (lines: Float64Array, settings: ToolSettings) => void;
  readonly failed: (message: string) => void;
}

/** A worker of the page, with an engine of its own. */
export function makeWorker(): Worker {
  const text = new Blob([embeddedText("worker")], { type: "text/javascript" });
  return new Worker(URL.createObjectURL(text));
}

/** The second engine, which runs each cycle of the first one under another rule: see lockstep.ts. */
export class SecondEngine {
  isReady = false;
  private worker: Worker | null = null;

  constructor(private readonly on: SecondEngineEvents) {}

  /** Reads an anatomy. */
  load(source: Source, settings: ToolSettings): void {
    this.isReady = false;
    if (this.worker === null) {
      this.worker = makeWorker();
      const handlers = this.handlers();
      this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => handled(handlers, data);
      this.worker.onerror = () => this.on.failed("the second engine has failed: reload this page");
      this.tell({ kind: "start", engine: embeddedText("engine"), subject: "tip" });
    }
    this.tell({ kind: "load", source, settings, port: null });
  }

  /** Returns the port at which it waits for cycles. */
  listen(): MessagePort {
    const { port1, port2 } = new MessageChannel();
    this.tell({ kind: "follow", port: port2 }, [port2]);
    return port1;
  }

  askForPath(): void {
    this.tell({ kind: "ask for path", use: "save" });
  }

  stop(): void {
    this.worker?.terminate();
    this.worker = null;
    this.isReady = false;
  }

  private tell(message: ToWorker, transfer: Transferable[] = []): void {
    this.worker?.postMessage(message, transfer);
  }

  private handlers(): Handlers<FromWorker> {
    let statuses: readonly StatusWords[] = [];
    const nothing = () => {};
    return {
      ready: (message) => {
        statuses = message.statuses;
      },
      surface: nothing,
      findings: nothing,
      guarded: () => {
        this.isReady = true;
        this.on.ready();
      },
      tool: nothing,
      state: ({ state }) => this.on.state(state, statuses),
      path: ({ lines, settings }) => this.on.path(lines, settings),
      replayed: nothing,
      counterexamples: nothing,
      shaded: nothing,
      settings: nothing,
      failure: ({ message }) => this.on.failed(message),
    };
  }
}
