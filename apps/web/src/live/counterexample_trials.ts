// SPDX-License-Identifier: BSD-3-Clause
import type { Keepout, Vec3 } from "../engine/keepout.ts";
import type { FromWorker, Trial } from "./protocol.ts";

/** Those of docs/activation.md that are shown: one of each kind of failure. */
const shown = ["CE2_boundary", "CE5_closed_octahedron", "CE6b_saddle"];
/** Distance to keep, where lengths are some 5. [length] */
const margin = 0.02;

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
      const trials = (["paper", "certified"] as const).map((rule): Trial => {
        const guard = keepout.guard(anatomy, {
          rule,
          radius: example.radius,
          toolRadius: 0,
          margin,
          maxStep: example.radius,
        });
        const { motion, status } = guard.step(example.tip, example.desired);
        guard.discard();
        const end = example.tip.map((value, i) => value + (motion[i] as number)) as unknown as Vec3;
        return { rule, status: keepout.statusName(status), end };
      });
      anatomy.discard();
      return { example, trials };
    });
  return { margin, examples };
}
