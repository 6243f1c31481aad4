// SPDX-License-Identifier: BSD-3-Clause
/** The file of a path of an instrument. */
import type { Rule, ToolFacts, ToolSettings } from "../engine/keepout.ts";
import { headerAndRows, mark, type PathHeader } from "./path_file.ts";
import type { EmbeddedMesh } from "./protocol.ts";

const rules: readonly string[] = ["none", "tip_only", "certified"] satisfies Rule[];
/** The numbers of a line that describe the commanded motion. */
const commanded = 6;

/** Returns the text of a path; numbers keep all their bits. */
export function robotPathText(
  { keepout, robot }: { keepout: string; robot: string },
  { rule, opening, margin, maxStep, radius, guides }: ToolSettings,
  { command_name, digest }: Pick<EmbeddedMesh, "command_name" | "digest">,
  base: readonly number[],
  { positions: joints, band, period }: Pick<ToolFacts, "positions" | "band" | "period">,
  lines: Float64Array,
): string {
  const made = { keepout, robot, rule, opening, margin, maxStep, radius, guides };
  const header = { ...made, mesh: command_name, digest, base, band, period };
  return [
    "# A path of keepout live --robot. Each line is a cycle of a millisecond: the positions of the",
    `# joints [rad, mm] (${joints}), their increments (${joints}), and the commanded motion of the flange:`,
    "# displacement [mm] (3) and rotation [rad] (3). A cycle that repeats the one before is omitted.",
    "# Open this file in the page to repeat it.",
    ...headerAndRows(header, lines, 2 * joints + commanded),
  ].join("\n");
}

/** Reads a path of an instrument. Throws for other texts. `usual`: settings that it may lack. */
export function parseRobotPath(
  text: string,
  usual: ToolSettings,
): { header: PathHeader; lines: Float64Array } {
  let header: PathHeader | null = null;
  const numbers: number[] = [];
  let width = 0;
  text.split(/\r?\n/).forEach((line, i) => {
    if (line.startsWith(mark)) header = parseHeader(line.slice(mark.length), usual);
    if (/^\s*(#|$)/.test(line)) return;
    const values = line.trim().split(/\s+/).map(Number);
    width ||= values.length;
    if (values.length !== width || !values.every(Number.isFinite)) {
      throw new Error(`line ${i + 1} does not have ${width} numbers: is the file cut off?`);
    }
    numbers.push(...values);
  });
  if (header === null) throw new Error("this is not a path of keepout live --robot");
  if (numbers.length === 0 || width <= commanded || width % 2 !== 0) {
    throw new Error("it has no cycle of an instrument");
  }
  if (!text.endsWith("\n")) throw new Error("its last line does not end: the file is cut off");
  return { header, lines: Float64Array.from(numbers) };
}

function parseHeader(text: string, usual: ToolSettings): PathHeader {
  const wrong = new Error("its header is not that of a path of keepout live --robot");
  let found: Partial<PathHeader & ToolSettings & { robot: string }>;
  try {
    found = JSON.parse(text);
  } catch {
    throw wrong;
  }
  const { keepout = "", robot, mesh, digest, base, margin, maxStep, guides = [] } = found ?? {};
  // Older paths have none of these: the jaw was closed, and certified.
  const { rule = "certified", opening = 0, radius = usual.radius } = found ?? {};
  const numbers = [margin, maxStep, opening, radius, ...(base ?? [Number.NaN])];
  if (typeof robot !== "string" || typeof mesh !== "string") throw wrong;
  if (!rules.includes(rule) || !numbers.every(Number.isFinite) || base?.length !== 12) throw wrong;
  if (!Array.isArray(guides) || !guides.every((one) => typeof one === "string")) throw wrong;
  const settings = { ...usual, rule, opening, radius, guides } as ToolSettings;
  return {
    keepout,
    mesh,
    digest,
    base,
    settings: { ...settings, margin: margin as number, maxStep: maxStep as number },
  };
}

/** Returns the joint positions at the start of a path. */
export const firstPositions = (lines: Float64Array, { positions }: ToolFacts): number[] => [
  ...lines.subarray(0, positions),
];
