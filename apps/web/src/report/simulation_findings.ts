// SPDX-License-Identifier: BSD-3-Clause
/** The differences between the runs of a simulation, in sentences and in a line of numbers. */
import { grouped } from "../page/elements.ts";
import { entries, valueAt } from "./record.ts";
import { differences, numbersLine } from "./report_page.ts";
import { runName } from "./runs.ts";
import { counted, listed, microseconds, millimetres, rounded, shown } from "./shown.ts";
import { bestRun, type SimulationRecord } from "./simulation_record.ts";

type Words = readonly (Node | string)[];

const isGuarded = (run: string): boolean => valueAt(`${run}/rule`) !== "none";
const has = (from: string): boolean => Number(valueAt(from)) > 0;
const guard = (run: string): Words =>
  isGuarded(run) ? [" with ", shown(`${run}/name`)] : [" without a fixture"];

/** True if a list ends in a name with a dot, as Li et al. */
const endsInDot = (parts: readonly Words[]): boolean => {
  const last = parts.at(-1)?.at(-1) ?? "";
  return (typeof last === "string" ? last : (last.textContent ?? "")).endsWith(".");
};

/** True if these words are in the headline, and need not be said again. */
const headlineSays = (words: string): boolean => String(valueAt("/headline")).includes(words);

/** Returns how far the tool went in, where it stood still, and the time of a step. */
export function simulationDifferences(record: SimulationRecord): HTMLElement[] {
  const runs = entries("/runs");
  const failed = runs.filter((run) => !valueAt(`${run}/kept_out`));
  const all = failed.filter((run) => has(`${run}/summary/deepest_mm`));
  const isTold = (run: string) => !isGuarded(run) && headlineSays("Without a fixture the tool");
  const deep = all.filter((run) => !isTold(run));
  const through = failed.filter(
    (run) => !all.includes(run) && !isTold(run) && has(`${run}/summary/crossings`),
  );
  const guarded = runs.filter(isGuarded);
  const timed = guarded.filter((run) => has(`${run}/summary/p50_us`));
  const [tool, crossed, noun] = record.has_convex_tool
    ? ["The tool", "touched the surface in ", "cycle"]
    : ["The tip", "passed through the surface ", "time"];
  const sentence = (begin: string, parts: readonly Words[]): Words =>
    parts.length > 0 ? [begin, ...listed(parts), endsInDot(parts) ? "" : "."] : [];
  return differences(
    sentence(
      `${tool} went `,
      deep.map((run) => [shown(`${run}/summary/deepest_mm`, millimetres), " deep", ...guard(run)]),
    ),
    sentence(
      `${tool} ${crossed}`,
      through.map((run) => [...counted(`${run}/summary/crossings`, noun), ...guard(run)]),
    ),
    !headlineSays("stood still in") && guarded.some((run) => has(`${run}/summary/stopped`))
      ? sentence(
          "It stood still for ",
          guarded.map((run) => [...counted(`${run}/summary/stopped`, "cycle"), ...guard(run)]),
        )
      : [],
    sentence(
      "The median step took ",
      timed.map((run) => [shown(`${run}/summary/p50_us`, microseconds), ...guard(run)]),
    ),
  );
}

/** Returns the most important numbers of the best run. */
export function simulationNumbers({ runs }: SimulationRecord): HTMLElement {
  const best = bestRun(runs);
  const from = `/runs/${best}/summary`;
  const isTimed = has(`${from}/p50_us`);
  const count = (name: string, key: string) => [name, shown(`${from}/${key}`, grouped)] as const;
  return numbersLine(
    [runName(best), valueAt(`/runs/${best}/kept_out`) ? "stayed out" : "went in"],
    ["closest approach", shown(`${from}/closest_approach_mm`, millimetres)],
    count("cycles", "cycles"),
    count("cycles limited", "limited"),
    count("cycles stopped", "stopped"),
    ...(isTimed
      ? ([
          ["median step", shown(`${from}/p50_us`, microseconds)],
          ["99 % of steps", shown(`${from}/p99_us`, microseconds)],
          ["rate", shown(`${from}/rate_khz`, (khz) => `${rounded(khz)}\u00a0kHz`)],
        ] as const)
      : []),
  );
}
