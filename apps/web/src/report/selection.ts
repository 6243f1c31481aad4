// SPDX-License-Identifier: BSD-3-Clause
import { make } from "../page/elements.ts";
import { Choices } from "./charts.ts";

/** Something that rows differ in, of which one at a time is chosen. */
export interface Question<Row> {
  readonly label: string;
  readonly of: (row: Row) => string;
  /** Where below a row the answer is in the record. */
  readonly from: string;
  /** A row of each answer, in their order; the first is chosen until another is. */
  readonly answers: readonly Row[];
}

/** Questions to the reader about which rows to show. */
export class Selection<Row extends { readonly from: string }> extends Choices {
  readonly element = make("div", { class: "selection" });
  private readonly chosen = new Map<Question<Row>, string>();

  constructor(questions: readonly Question<Row>[]) {
    super();
    for (const question of questions) {
      const { label, of, from, answers } = question;
      const options = answers.map((row) =>
        make("option", { value: of(row), "data-from": row.from + from }, of(row)),
      );
      const list = make("select", {}, ...options);
      this.chosen.set(question, list.value);
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
