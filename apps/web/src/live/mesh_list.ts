// SPDX-License-Identifier: BSD-3-Clause
import { make } from "../page/elements.ts";
import { element } from "./page.ts";
import type { EmbeddedMesh, Source } from "./protocol.ts";

/** An anatomy to choose, and its name on a command line. */
export interface Choice {
  readonly source: Source;
  readonly command: string;
}

export const nameOf = ({ source }: Choice): string =>
  source.kind === "embedded" ? source.mesh.name : source.name;

/** The mesh of a choice that `keepout live` has put into the page. */
export const meshOf = (choice: Choice | null): EmbeddedMesh | undefined =>
  choice?.source.kind === "embedded" ? choice.source.mesh : undefined;

/** The list of anatomies. */
export class MeshList {
  private readonly list = element("mesh", HTMLSelectElement);
  /** By the values of the list's options. */
  private readonly choices: Choice[] = [];

  constructor(private readonly load: (choice: Choice) => void) {
    this.list.addEventListener("change", () => this.choose());
  }

  /** Loads the selected anatomy. */
  choose(): void {
    const choice = this.choices[Number(this.list.value)];
    if (choice !== undefined) this.load(choice);
  }

  /** Adds a choice to the list, under a heading. */
  offer(heading: string, choice: Choice): void {
    let group = this.list.querySelector<HTMLOptGroupElement>(`optgroup[label="${heading}"]`);
    if (group === null) {
      group = make("optgroup", { label: heading });
      this.list.append(group);
    }
    group.append(new Option(nameOf(choice), String(this.choices.length)));
    this.choices.push(choice);
  }

  /** Selects the anatomy that is shown, even if loading another one has failed. */
  select(shown: Choice | null): void {
    if (shown === null) return;
    if (!this.choices.includes(shown)) this.offer("Opened", shown);
    this.list.value = String(this.choices.indexOf(shown));
  }

  /** Returns the choice with this name on a command line. */
  called(command: string): Choice | undefined {
    return this.choices.find((choice) => choice.command === command);
  }

  /** Returns a sample mesh in the page, which may come from its file, or a generated mesh. */
  sample(name: string): Choice | undefined {
    const isIt = (choice: Choice) => meshOf(choice)?.name === `${name}.stl`;
    return this.called(name) ?? this.choices.find(isIt);
  }
}
