// SPDX-License-Identifier: BSD-3-Clause
/** Functions for tests of the paths that a page of `keepout live` saves. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";

/** Returns the numbers in the lines of a path. */
export const linesOf = ({ text }) =>
  text
    .split("\n")
    .filter((line) => line !== "" && !line.startsWith("#"))
    .map((line) => line.split(" ").map(Number));

/** Runs the command in the head of a path in a folder. Returns the rows of STEPS.csv. */
export function replayedPath(keepout, folder, { file, text }, mesh, rule) {
  const line = text.split("\n").find((one) => one.startsWith("#   keepout replay "));
  const words = line
    .match(/'[^']*'|\S+/g)
    .slice(2) // past "# keepout"
    .map((word) => ({ THIS_FILE: file, RULE: rule })[word] ?? word);
  words[1] = mesh;
  execFileSync(keepout, words, { encoding: "utf8", cwd: folder, maxBuffer: 1 << 26 });
  const [, ...rows] = readFileSync(join(folder, "steps.csv"), "utf8").trim().split("\n");
  return rows.map((row) => row.split(","));
}

/** Returns the number of cycles in which the tool positions of path and replay are not bitwise identical. */
export function differing(lines, rows) {
  assert.equal(rows.length, lines.length);
  return lines.filter((line, i) =>
    [0, 1, 2].some((axis) => !Object.is(line[3 + axis], Number(rows[i][2 + axis]))),
  ).length;
}

/** Returns the motions between the tool positions of a path, in the format of replay. */
export function stepsText(lines) {
  const steps = lines.slice(1).map((line, i) => {
    const tip = lines[i].slice(3);
    const motion = tip.map((value, axis) => line[3 + axis] - value);
    return [i, "free", ...tip, ...motion, ...motion].join(",");
  });
  return `head\n${steps.join("\n")}\n`;
}
