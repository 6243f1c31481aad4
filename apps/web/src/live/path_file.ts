// SPDX-License-Identifier: BSD-3-Clause
import type { Rule, ToolSettings } from "../engine/keepout.ts";

/** The settings of a path. In the file of a tip they are JSON, after "# path: ". */
export interface PathHeader {
  readonly keepout: string;
  /** As for `keepout replay`: a file, or the name of a sample mesh. */
  readonly mesh: string;
  readonly settings: ToolSettings;
  /** The digest of the mesh if it is known, and the port; of an instrument only. */
  readonly digest?: string | undefined;
  readonly base?: readonly number[];
}

/** Stands before the header of a path. */
export const mark = "# path: ";
const decimal = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const rules: readonly string[] = ["none", "all_faces", "paper", "certified"] satisfies Rule[];

/**
 * Returns a pose file for `keepout replay --closed-loop`. Each line is a cycle: the position of the
 * hand, and the position of the tool before the cycle, of which replay uses the first. Numbers keep
 * all their bits.
 */
export function pathText(header: PathHeader, lines: Float64Array): string {
  const { settings } = header;
  return [
    "# A path of keepout live: gx gy gz rx ry rz [mm], a line for each cycle of a millisecond: where",
    "# the hand was, and where the tool was before it. A cycle like the one before is left out.",
    settings.rule === "none"
      ? "# There was no fixture; to replay it, choose a rule with --activation."
      : "# To do it again, and find the tool in columns px py pz, bit for bit:",
    `#   ${replayCommand(header, "THIS_FILE")}`,
    ...headerAndRows(header, lines, 6),
  ].join("\n");
}

/** Returns the lines of a path: its header as JSON, and its numbers in rows. */
export function headerAndRows(header: object, lines: Float64Array, width: number): string[] {
  const rows = [mark + JSON.stringify(header)];
  for (let i = 0; i < lines.length; i += width) {
    rows.push([...lines.subarray(i, i + width)].map(numberText).join(" "));
  }
  return [...rows, ""];
}

/** Returns the command that repeats a path. */
export function replayCommand({ mesh, settings }: PathHeader, file: string): string {
  const rule = settings.rule === "none" ? "RULE" : settings.rule;
  return (
    `keepout replay ${mesh} --closed-loop --poses ${file} --out steps.csv --activation ${rule}` +
    ` --radius ${settings.radius} --tool-radius ${settings.toolRadius} --margin ${settings.margin}` +
    ` --max-step ${settings.maxStep}` +
    settings.guides.map((guide) => ` --guide ${shellWord(guide)}`).join("")
  );
}

const shellWord = (text: string): string =>
  /^[\w=:,.+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;

/** Reads a path, or any pose file of a closed loop, which has no header. Throws for other texts. */
export function parsePath(text: string): { header: PathHeader | null; lines: Float64Array } {
  let header: PathHeader | null = null;
  const numbers: number[] = [];
  text.split(/\r?\n/).forEach((line, i) => {
    if (line.startsWith(mark)) header = parseHeader(line.slice(mark.length), i + 1);
    if (/^\s*(#|$)/.test(line)) return;
    const words = line.trim().split(/\s*,\s*|\s+/);
    const values = words.map((word) => (decimal.test(word) ? Number(word) : Number.NaN));
    if (values.length !== 6 || !values.every(Number.isFinite)) {
      throw new Error(`line ${i + 1}: six numbers are needed, 'gx gy gz rx ry rz', in mm`);
    }
    numbers.push(...values);
  });
  if (numbers.length === 0) throw new Error("there is no cycle in it: is this a path?");
  if (header !== null && !text.endsWith("\n"))
    throw new Error("the file is cut: its last line has no end");
  return { header, lines: Float64Array.from(numbers) };
}

function parseHeader(text: string, line: number): PathHeader {
  const wrong = new Error(`line ${line}: its header is none of a path of keepout live`);
  let header: Partial<PathHeader>;
  try {
    header = JSON.parse(text);
  } catch {
    throw wrong;
  }
  const settings: Partial<ToolSettings> = header?.settings ?? {};
  const lengths = [settings.radius, settings.toolRadius, settings.margin, settings.maxStep];
  if (typeof header?.mesh !== "string") throw wrong;
  if (!rules.includes(settings.rule ?? "") || !lengths.every(Number.isFinite)) throw wrong;
  const { guides = [] } = settings; // older paths have no guides
  if (!Array.isArray(guides) || !guides.every((text) => typeof text === "string")) throw wrong;
  return { ...(header as PathHeader), settings: { ...(settings as ToolSettings), guides } };
}

/** Returns the fewest digits that read back exactly; JavaScript would drop the sign of zero. */
function numberText(value: number): string {
  return Object.is(value, -0) ? "-0" : String(value);
}
