// SPDX-License-Identifier: BSD-3-Clause
import { type Keepout, Tool, type Vec3 } from "../engine/keepout.ts";
import type { FromWorker } from "./protocol.ts";

/** Those of docs/activation.md that are shown: one of each kind of failure. */
const shown = ["CE2_boundary", "CE5_closed_octahedron", "CE6c_larger_saddle"];
/** Distance to keep, where edges are some 5: the certified rule needs one. [length] */
const margin = 0.001;

/** What each comes to in one step under the paper's rule, and under the certified one. */
export function runCounterexamples(
  keepout: Keepout,
): Omit<Extract<FromWorker, { kind: "counterexamples" }>, "kind"> {
  const examples = keepout
    .counterexamples()
    .filter((example) => shown.includes(example.name))
    .map((example) => {
      const anatomy = keepout.anatomyOfSurface(
        Float64Array.from(example.vertices.flat()),
        Uint32Array.from(example.triangles.flat()),
      );
      const ends = (["paper", "certified"] as const).map((rule): Vec3 => {
        const { radius, tip, desired } = example;
        const settings = { rule, radius, toolRadius: 0, margin, maxStep: radius, guides: [] };
        const tool = new Tool(keepout, anatomy, settings, null);
        const { motion } = tool.step([...tip, ...desired]);
        tool.made.delete();
        return tip.map((value, i) => value + (motion[i] as number)) as unknown as Vec3;
      });
      anatomy.delete();
      return { example, ends };
    });
  return { margin, examples };
}
