// SPDX-License-Identifier: BSD-3-Clause
/**
 * The mode with two scenes: one hand, one camera, and two engines. On the left, or above, the tool has no fixture or
 * the rule of Li et al. (2020); on the right, or below, the certified rule.
 */
import type { Rule, StatusWords, ToolSettings } from "../engine/keepout.ts";
import { colorOf } from "../page/color_of.ts";
import { CounterexampleView } from "./counterexample_view.ts";
import type { Choice } from "./mesh_list.ts";
import { element, set, toast } from "./page.ts";
import type { FromWorker, State, ToWorker } from "./protocol.ts";
import { SecondEngine } from "./second_engine.ts";
import { SecondTool } from "./second_tool.ts";
import { SideHead } from "./side_head.ts";
import { statusShown } from "./status_words.ts";
import { linesOf, settingsOf, type WallStroke, wallStrokes } from "./strokes.ts";
import type { ToolScene } from "./tool_scene.ts";

/** The page around the mode. */
export interface SideBySideHost {
  readonly scene: ToolScene;
  readonly tell: (message: ToWorker, transfer?: Transferable[]) => void;
  readonly settings: () => ToolSettings;
  readonly change: (part: Partial<ToolSettings>) => void;
  /** Releases the hand from any input. */
  readonly drop: () => void;
  readonly shown: () => Choice | null;
  readonly isLoading: () => boolean;
  readonly load: (choice: Choice) => void;
  readonly sample: (name: string) => Choice | undefined;
  readonly savePath: (lines: Float64Array, settings: ToolSettings) => void;
}

const yours = "Drag the red ring in either scene: both tools get the same hand.";

export class SideBySide {
  private readonly heads = [...document.querySelectorAll("#sides .side")].map(
    (side) => new SideHead(side),
  );
  private readonly rule = element("sides-rule", HTMLSelectElement);
  private readonly shows = element("sides-show", HTMLSelectElement);
  private readonly pauseButton = element("sides-pause", HTMLButtonElement);
  private readonly second = new SecondTool();
  private readonly secondEngine: SecondEngine;
  private readonly trials: CounterexampleView;
  private statuses: readonly StatusWords[] = [];
  /** The page before the mode; null: the mode is off. */
  private before: { settings: ToolSettings; choice: Choice | null } | null = null;
  private isPaired = false;
  private isPaused = false;
  /** The stroke to play as soon as both engines are ready; then the one that plays. */
  private due: WallStroke | null = null;
  private playing: WallStroke | null = null;

  constructor(private readonly host: SideBySideHost) {
    this.secondEngine = new SecondEngine({
      ready: () => this.pair(),
      state: (state, statuses) => this.showSecond(state, statuses),
      path: (lines, settings) => this.host.savePath(lines, settings),
      failed: toast,
    });
    this.trials = new CounterexampleView(element("sides", HTMLElement), this.heads);
    element("compare", HTMLButtonElement).onclick = () => this.enter();
    element("sides-close", HTMLButtonElement).onclick = () => this.leave();
    element("sides-play", HTMLButtonElement).onclick = () => this.playStroke();
    element("sides-save", HTMLButtonElement).onclick = () => {
      this.host.tell({ kind: "ask for path", use: "save" });
      this.secondEngine.askForPath();
    };
    this.pauseButton.onclick = () => this.pause(!this.isPaused);
    this.rule.onchange = () => this.chooseRule(this.rule.value as Rule);
    this.shows.onchange = () => this.choose(this.shows.value);
  }

  get isOn(): boolean {
    return this.before !== null;
  }

  /** True if time stands still, because the visitor has paused it or looks at a counterexample. */
  get isStill(): boolean {
    return this.isOn && (this.isPaused || this.trials.isOpen);
  }

  enter(): void {
    if (this.isOn) return;
    this.before = { settings: this.host.settings(), choice: this.host.shown() };
    this.host.drop();
    document.body.classList.add("two");
    this.host.scene.pair(this.second);
    this.paint();
    this.host.change({ rule: "certified" });
    set("sides-words", yours);
    this.shows.value = "hand";
    this.rule.focus();
    const shown = this.host.shown();
    if (!this.host.isLoading() && shown !== null) this.loading(shown);
  }

  leave(): void {
    if (this.before === null) return;
    const { settings, choice } = this.before;
    this.trials.close();
    this.before = this.due = this.playing = null;
    this.isPaired = false;
    this.pause(false);
    this.host.tell({ kind: "lead", port: null, rule: "none" });
    this.secondEngine.stop();
    this.second.clear();
    document.body.classList.remove("two");
    this.host.scene.pair(null);
    this.host.change(settings);
    if (choice !== null && choice !== this.host.shown()) this.host.load(choice);
    element("compare", HTMLButtonElement).focus();
  }

  /** Shows the counterexamples to the rule of Li et al., the closed solid first. */
  showTrials(): void {
    this.enter();
    this.choose("CE5_closed_octahedron");
  }

  /** Plays the stroke through the wall of an open mesh. */
  playStroke(): void {
    const found = wallStrokes
      .map((stroke) => ({ stroke, choice: this.host.sample(stroke.mesh) }))
      .find(({ choice }) => choice !== undefined);
    if (found?.choice === undefined || this.host.isLoading()) return;
    this.enter();
    this.choose("hand");
    this.due = found.stroke;
    if (this.host.shown() !== found.choice) this.host.load(found.choice);
    else if (this.isPaired) this.begin();
  }

  /** The page reads an anatomy. */
  loading({ source }: Choice): void {
    if (!this.isOn) return;
    this.isPaired = false;
    this.second.clear();
    this.secondEngine.load(source, this.host.settings());
  }

  /** The page has read an anatomy, and placed its tool. */
  loaded(): void {
    this.pair();
  }

  /** Shows the first tool's state. */
  show(state: State, statuses: readonly StatusWords[]): void {
    this.statuses = statuses;
    if (this.isOn && !this.trials.isOpen) this.showHead(1, state, true);
  }

  /** Opens the counterexamples. */
  openTrials(message: Extract<FromWorker, { kind: "counterexamples" }>): void {
    if (!this.isOn || this.shows.value === "hand") return;
    this.trials.open(message);
    this.trials.choose(this.shows.value);
    this.rule.disabled = true;
    this.rule.value = "paper";
    this.pause(false);
  }

  /** A replay has ended. Returns true if it was a stroke of this mode. */
  ended(): boolean {
    if (this.playing === null) return false;
    set("sides-words", `${this.playing.why} ${yours}`);
    this.playing = null;
    return true;
  }

  /** A key chooses a rule: of the left tool. */
  chooseRule(rule: Rule): void {
    if (rule !== "none" && rule !== "paper") return;
    this.rule.value = rule;
    this.paint();
    this.host.tell({ kind: "rule of the follower", rule });
  }

  paint(): void {
    this.second.paint(colorOf(`--rule-${this.rule.value}`));
  }

  /** Connects both engines once both have read the anatomy. */
  private pair(): void {
    if (!this.isOn || !this.secondEngine.isReady || this.host.isLoading() || this.isPaired) return;
    this.isPaired = true;
    const port = this.secondEngine.listen();
    this.host.tell({ kind: "lead", port, rule: this.rule.value as Rule }, [port]);
    if (this.due !== null) this.begin();
  }

  private begin(): void {
    const stroke = this.due;
    if (stroke === null) return;
    this.due = null;
    this.playing = stroke;
    this.pause(false);
    this.host.drop();
    this.host.change({ rule: "certified", ...settingsOf(stroke) });
    this.chooseRule("paper");
    this.host.scene.lookFrom(stroke.target, stroke.direction, stroke.length);
    this.second.clear();
    set("sides-words", stroke.begin);
    this.host.tell({ kind: "replay", lines: linesOf(stroke), isHeld: true });
  }

  private choose(value: string): void {
    this.shows.value = value;
    if (value !== "hand") {
      this.host.tell({ kind: "ask for counterexamples" });
      return;
    }
    this.trials.close();
    for (const head of this.heads) head.show("starting", "free", Number.NaN);
    this.second.clear();
    this.rule.disabled = false;
    set("sides-words", yours);
    this.pause(false);
  }

  private pause(isPaused: boolean): void {
    this.isPaused = isPaused;
    set(this.pauseButton, isPaused ? "Play" : "Pause");
    this.trials.pause(isPaused);
    this.host.tell({ kind: "pause", paused: this.isStill || document.hidden });
  }

  private showSecond(state: State, statuses: readonly StatusWords[]): void {
    this.statuses = statuses;
    this.host.scene.updateSecond(state);
    if (!this.trials.isOpen) this.showHead(0, state, this.rule.value !== "none");
  }

  private showHead(side: number, state: State, isGuarded: boolean): void {
    const name = this.statuses[state.status]?.name ?? "unknown";
    const { chip, mood } = statusShown(name, state, isGuarded);
    const isThrough = state.crossings > 0;
    this.heads[side]?.show(
      isThrough ? "went through the wall" : chip,
      isThrough ? "stopped" : mood,
      Math.min(...state.clearances),
      state.crossings % 2 === 1,
    );
  }
}
