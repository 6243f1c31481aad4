// SPDX-License-Identifier: BSD-3-Clause
/**
 * Two engines with one hand. The leader runs on its clock, and sends the hand of each cycle over a port to the
 * follower, which runs the same cycles. So both tools get bitwise the same hand in the same cycle.
 */
import { type Rule, type ToolSettings, unturned } from "../engine/keepout.ts";
import type { ControlLoop } from "./control_loop.ts";

/** The leader waits if the follower is more cycles behind. */
const mostAhead = 200;

type ToFollower =
  /** Places the tool; makes it at first. */
  | {
      readonly kind: "place";
      readonly positions: readonly number[];
      readonly settings: ToolSettings;
    }
  /** Continues with other settings. */
  | { readonly kind: "settings"; readonly settings: ToolSettings }
  /** `hands`: (n, 3), the hand of each cycle. `time`: when the leader reported its state, or null. */
  | { readonly kind: "cycles"; readonly hands: Float64Array; readonly time: number | null };

/** The leader's side. */
export class Leader {
  private hands: number[] = [];
  /** The cycles that the follower has not run yet. */
  private ahead = 0;

  /** `rule`: that of the follower. */
  constructor(
    private readonly port: MessagePort,
    private rule: Rule,
  ) {
    port.onmessage = ({ data }: MessageEvent<number>) => {
      this.ahead -= data;
    };
  }

  /** True if the leader must wait for the follower. */
  get isAhead(): boolean {
    return this.ahead > mostAhead;
  }

  place(loop: ControlLoop): void {
    const { positions } = loop.last;
    this.send({ kind: "place", positions, settings: { ...loop.settings, rule: this.rule } });
  }

  use(settings: ToolSettings, rule = this.rule): void {
    this.rule = rule;
    this.send({ kind: "settings", settings: { ...settings, rule } });
  }

  /** Adds the hand of the cycle that the leader has just run. */
  add({ last }: ControlLoop): void {
    this.hands.push(...last.asked);
  }

  /** Sends the hands of the last cycles. */
  flush(time: number | null): void {
    if (this.hands.length === 0 && time === null) return;
    this.ahead += this.hands.length / 3;
    const hands = Float64Array.from(this.hands);
    this.hands = [];
    this.send({ kind: "cycles", hands, time });
  }

  close(): void {
    this.port.close();
  }

  private send(message: ToFollower): void {
    this.port.postMessage(message);
  }
}

/** The work of the follower in its worker. */
export interface FollowerWork {
  /** Places the tool; makes it at first. */
  readonly place: (positions: readonly number[], settings: ToolSettings) => void;
  readonly use: (settings: ToolSettings) => void;
  readonly loop: () => ControlLoop | null;
  readonly tell: (time: number) => void;
  readonly fail: (error: unknown) => void;
}

/** Runs the cycles that arrive at a port. */
export function follow(port: MessagePort, work: FollowerWork): void {
  const handle = (message: ToFollower) => {
    if (message.kind === "place") work.place(message.positions, message.settings);
    else if (message.kind === "settings") work.use(message.settings);
    else {
      const { hands, time } = message;
      for (let i = 0; i < hands.length; i += 3) {
        const place = [hands[i], hands[i + 1], hands[i + 2]] as [number, number, number];
        work.loop()?.follow({ place, turn: unturned });
      }
      port.postMessage(hands.length / 3);
      if (time !== null) work.tell(time);
    }
  };
  port.onmessage = ({ data }: MessageEvent<ToFollower>) => {
    try {
      handle(data);
    } catch (error) {
      work.fail(error);
    }
  };
}
