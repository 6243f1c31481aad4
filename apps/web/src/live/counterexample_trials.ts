// SPDX-License-Identifier: BSD-3-Clause
import { type Keepout, Tool, type Vec3 } from "../engine/keepout.ts";
import type { FromWorker } from "./protocol.ts";

/** Counterexamples of docs/activation.md, one for each kind of failure. */
const shown = ["CE2_boundary", "CE5_closed_octahedron", "CE6c_larger_saddle"];
/** The required clearance, which the certified rule needs. Edges are about 5 long. [length] */
const margin = 0.001;

/**
 * Returns the end of one step for each counterexample, under the rule of Li et al. (2020) and under
 * the certified rule.
 */
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
      const ends = (["paper", "certified"] as const).map((rule) => {
        const { radius, tip, desired } = example;
        const settings = { rule, radius, toolRadius: 0, margin, maxStep: radius, guides: [] };
        const tool = new Tool(keepout, anatomy, settings, null);
        const { motion } = tool.step([...tip, ...desired]);
        tool.made.delete();
        const place = tip.map((value, i) => value + (motion[i] as number)) as unknown as Vec3;
        return { place, clearance: anatomy.clearance(...place) };
      });
      anatomy.delete();
      return { example, ends };
    });
  return { margin, examples };
}
