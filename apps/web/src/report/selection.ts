// SPDX-License-Identifier: BSD-3-Clause
import { Choices } from "./charts.ts";
import { make } from "./shown.ts";

/** Something that rows differ in, of which one at a time is chosen. */
export interface Question<Row> {
  readonly label: string;
  readonly of: (row: Row) => string;
  /** The answers, in their order; the first is chosen until another is. */
  readonly answers: readonly string[];
}

/** Questions to the reader about which rows to show. */
export class Selection<Row> extends Choices {
  readonly element = make("div", { class: "selection" });
  private readonly chosen = new Map<Question<Row>, string>();

  constructor(questions: readonly Question<Row>[]) {
    super();
    for (const question of questions) {
      const { label, answers } = question;
      this.chosen.set(question, answers[0] ?? "");
      const list = make("select", {}, ...answers.map((answer) => make("option", {}, answer)));
      list.addEventListener("change", () => {
        this.chosen.set(question, list.value);
        this.changed();
      });
      if (answers.length > 1) this.element.append(make("label", {}, label, " ", list));
    }
  }

  /** Whether a row is one of those chosen; `ignored`: what does not matter. */
  has(row: Row, ...ignored: readonly Question<Row>[]): boolean {
    return [...this.chosen].every(
      ([question, answer]) => ignored.includes(question) || question.of(row) === answer,
    );
  }
}
