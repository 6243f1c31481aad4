// SPDX-License-Identifier: BSD-3-Clause
import { make } from "../page/elements.ts";
import { Choices } from "./charts.ts";
import { ruleName } from "./shown.ts";

/** A property that differs between rows; the reader chooses one value. */
export interface Question<Row> {
  readonly label: string;
  readonly of: (row: Row) => string;
  /** The pointer to the value, below a row. */
  readonly from: string;
  /** One row for each value, in order; the first is the default. */
  readonly answers: readonly Row[];
}

/** The reader's selection of rows to show. */
export class Selection<Row extends { readonly from: string }> extends Choices {
  readonly element = make("div", { class: "selection" });
  private readonly chosen = new Map<Question<Row>, string>();

  constructor(questions: readonly Question<Row>[]) {
    super();
    for (const question of questions) {
      const { label, of, from, answers } = question;
      const options = answers.map((row) =>
        make("option", { value: of(row), "data-from": row.from + from }, ruleName(of(row))),
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

  /** True if a row is selected; `ignored`: questions that do not matter. */
  has(row: Row, ...ignored: readonly Question<Row>[]): boolean {
    return [...this.chosen].every(
      ([question, answer]) => ignored.includes(question) || question.of(row) === answer,
    );
  }
}
