// SPDX-License-Identifier: BSD-3-Clause
import type { Findings } from "../engine/keepout.ts";
import { grouped, make } from "../page/elements.ts";
import { element, set } from "./page.ts";

/** Shows the findings of `keepout inspect` on the mesh, and the warnings of `keepout live`. */
export function showFindings(
  { watertight, size, warnings, findings }: Findings,
  triangles: number,
  told: readonly string[],
): void {
  const details = element("findings", HTMLDetailsElement);
  const lines = [
    ...findings.map(({ text, advice }) => `${text}. What to do: ${advice}.`),
    ...[...warnings, ...told].map((warning) => `${warning}.`),
  ];
  const facts =
    `${grouped(triangles)} triangles; ${size.map((length) => Number(length.toPrecision(4))).join(" × ")} mm; ` +
    (watertight ? "watertight" : "not watertight");
  const count = lines.length;
  set(
    details.querySelector("summary"),
    count === 0 ? "The mesh: nothing wrong" : `The mesh: ${count} finding${count > 1 ? "s" : ""}`,
  );
  const items = lines.map((line) => make("li", {}, line));
  details.querySelector("div")?.replaceChildren(make("p", {}, facts), make("ul", {}, ...items));
}
