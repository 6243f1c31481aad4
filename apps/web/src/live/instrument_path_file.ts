// SPDX-License-Identifier: BSD-3-Clause
import type { InstrumentFacts } from "../engine/manipulator.ts";
import type { InstrumentMesh } from "./instrument_protocol.ts";
import { numberText } from "./path_file.ts";

/**
 * A path of an instrument: a head that says what it was made with, as JSON after "# path: ", and a
 * line a cycle. All bits are kept.
 */
export function instrumentPathText(
  made: { keepout: string; robot: string; margin: number; maxStep: number },
  { command_name, digest, start }: InstrumentMesh,
  { joints, band, period }: InstrumentFacts,
  lines: Float64Array,
): string {
  const header = { ...made, mesh: command_name, digest, base: start.base, band, period };
  const width = 2 * joints + 6;
  const rows: string[] = [];
  for (let i = 0; i < lines.length; i += width) {
    rows.push([...lines.subarray(i, i + width)].map(numberText).join(" "));
  }
  return [
    "# A path of keepout live --robot, a line for each cycle of a millisecond: where the joints were [rad,",
    `# mm] (${joints}), by how much they went (${joints}), and what was asked of the flange: how it should move [mm]`,
    "# (3) and turn [rad] (3). A cycle like the one before is left out.",
    `# path: ${JSON.stringify(header)}`,
    ...rows,
    "",
  ].join("\n");
}
