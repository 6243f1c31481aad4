// SPDX-License-Identifier: BSD-3-Clause
import { make } from "../page/elements.ts";
import type { BenchmarkRow } from "./benchmark.ts";
import { valueAt } from "./record.ts";
import { method, section } from "./report_page.ts";
import { rounded, shown, shownMembers } from "./shown.ts";

const term = (name: string): HTMLElement => make("b", {}, name);

/** Describes how and on what a benchmark was measured, and the names of its parts. */
export function benchmarkMethod(from: string, rows: readonly BenchmarkRow[]): HTMLElement {
  const hasNlopt = rows.some(({ solver }) => solver.startsWith("nlopt"));
  const clock = `${from}/machine/clock_ns`;
  return section(
    "How it was measured, and what the names stand for",
    make(
      "div",
      { class: "panels wide", style: "--columns:2" },
      make("figure", {}, make("dl", { class: "long" }, ...shownMembers(`${from}/parts`))),
      make(
        "div",
        {},
        method(
          "All combinations draw on the same seeded motions; a slow one is asked the first of them only, and the table says how many: rows of few queries compare by their order of magnitude. Each is a MotionConstraint as users make one, but takes its tips as they are: to place a tip that no step led to is not part of it. It is asked twice for the same motions, stage by stage and as a whole, and only what was right both times has times. Steps with active_set are held, bit for bit, to those of pd_tree with active_set and the plain form of the rule, which are held to brute force in a sample of eight places for each rule and radius; those of other solvers within the solver’s stated accuracy. Under the rule certified another solver’s motion counts as right because the rule has proven it; the column ",
          term("worse"),
          " tells how many fell short of the reference by more than a thousandth of the motion. The triangles of every query are held, bit for bit, to those of pd_tree, and to brute force in the same sample. Rows with more than 1 % of the steps without an answer are in the table, but not ranked, nor are those that ",
          term("reach any"),
          " triangle in fewer than half of the motions.",
        ),
        method(
          term("Candidates only"),
          " is what the index proposes; ",
          term("query"),
          " is that, the exact test of each candidate, the closest point of each hit, and their sorting: the same work for every index, around the same places, apart from the step. ",
          term("Find"),
          " is the query as it is part of the step; it is empty where the rule searches the tree by itself. ",
          term("Activate"),
          " makes planes of the triangles; ",
          term("solve"),
          " searches for the motion: the solver’s work and, under certified, the rule’s proofs; ",
          term("step"),
          " is all of it, one call, timed in a round of its own, so that the medians of stages need not add up to its median. ",
          term("Planes"),
          " are those the solver was given in the end. Loading the mesh and building the index are not part of it.",
          hasNlopt
            ? " NLopt’s times include posing the problem without units and proving the answer."
            : "",
        ),
        method(
          "Percentiles are by nearest rank: times that did occur. The 99 % needs a hundred samples, the 99.9 % a thousand. The slowest step includes whatever else the machine did meanwhile.",
          ...(valueAt<number>(clock)
            ? [
                " Reading the clock adds ",
                shown(clock, (ns) => `${rounded(ns)} ns`),
                " to each time, which is not taken off.",
              ]
            : []),
        ),
        method(
          "Neither times nor their ratios carry over to another machine or another SIMD target: measure there.",
        ),
      ),
    ),
  );
}
