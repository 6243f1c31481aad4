// SPDX-License-Identifier: BSD-3-Clause
/**
 * Tests that readers with red-green color blindness see the colors of the rules apart, in light and dark:
 *
 *   rule_colors_test.mjs CSS
 */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

const css = readFileSync(process.argv[2], "utf8");
const colors = [...css.matchAll(/--rule-([\w-]+): light-dark\((#\w{6}), (#\w{6})\)/g)];

/** Approximate vision, as a matrix in linear RGB. */
const views = {
  usual: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.1124, 0.8876, 0, 0.1124, 0.8876, 0, 0.004, -0.004, 1],
  deuteranopia: [0.2928, 0.7072, 0, 0.2928, 0.7072, 0, -0.0223, 0.0223, 1],
};
const times = (matrix, [a, b, c]) =>
  [0, 3, 6].map((i) => matrix[i] * a + matrix[i + 1] * b + matrix[i + 2] * c);
const linear = (hex) =>
  [1, 3, 5].map((at) => {
    const value = Number.parseInt(hex.slice(at, at + 2), 16) / 255;
    return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  });

/** Returns the coordinates of a color in OKLab, in which distances are perceptual. */
function perceived(hex, view) {
  const seen = times(view, linear(hex)).map((value) => Math.min(Math.max(value, 0), 1));
  const cones = times(
    [
      0.4122214708, 0.5363325363, 0.0514459929, 0.2119034982, 0.6806995451, 0.1073969566,
      0.0883024619, 0.2817188376, 0.6299787005,
    ],
    seen,
  ).map(Math.cbrt);
  return times(
    [
      0.2104542553, 0.793617785, -0.0040720468, 1.9779984951, -2.428592205, 0.4505937099,
      0.0259040371, 0.7827717662, -0.808675766,
    ],
    cones,
  );
}

for (const [scheme, at] of [
  ["light", 2],
  ["dark", 3],
]) {
  for (const [kind, view] of Object.entries(views)) {
    test(`the rules differ: ${scheme}, ${kind}`, () => {
      assert.equal(colors.length, 4);
      for (const [i, a] of colors.entries()) {
        for (const b of colors.slice(0, i)) {
          const [p, q] = [a, b].map((one) => perceived(one[at], view));
          const away = Math.hypot(...p.map((value, axis) => value - q[axis]));
          assert.ok(away >= 0.08, `${a[1]} and ${b[1]} differ by ${away.toFixed(3)} only`);
        }
      }
    });
  }
}
