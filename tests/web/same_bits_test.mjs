// SPDX-License-Identifier: BSD-3-Clause
//
// Compares the steps of the native command and of the WebAssembly module: none of 27,000 may differ in any
// bit (of 108,000 in `./test --long`), with three rules on three meshes.
//
//     node same_bits_test.mjs KEEPOUT BUILD_WASM
//
// `keepout replay` and the module of the pages make the steps of the same seeded poses, one by one
// and in a closed loop, near the surface and into it. All common results are compared as numbers,
// including the sign of zero: status, tip, motion, distance, planes, and triangles in reach.
//
// The number of triangles that the certified rule examined is not compared. It depends on a
// reciprocal square root in single precision, which each processor rounds differently. Native AVX2
// and SSE4 also differ in some of 10,000 steps. One mesh is read as text, so that parsed numbers
// are compared as well.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { isLong } from "./tabs.mjs";

const [command, buildFolder] = process.argv.slice(2).map((path) => resolve(path));
assert(buildFolder, "usage: node same_bits_test.mjs KEEPOUT BUILD_WASM");
const repository = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
const fixtures = join(process.env.KEEPOUT_CACHE || join(repository, ".cache"), "fixtures");
const scratch = mkdtempSync(join(tmpdir(), "keepout-same-bits-"));
process.on("exit", () => rmSync(scratch, { recursive: true, force: true }));

// The pages use this module. It is in TypeScript, which node cannot read.
const { buildSync } = createRequire(join(repository, "apps/web/package.json"))("esbuild");
const engine = join(scratch, "keepout.mjs");
const source = join(repository, "apps/web/src/engine/keepout.ts");
buildSync({ entryPoints: [source], outfile: engine, bundle: true, format: "esm" });
const { loadKeepout, Tool } = await import(pathToFileURL(engine));
const { default: instantiate } = await import(pathToFileURL(join(buildFolder, "keepout.mjs")));
const keepout = await loadKeepout(instantiate, readFileSync(join(buildFolder, "keepout.wasm")));

const statuses = keepout.statuses("tip");

const share = isLong ? 1 : 4;
const openSteps = 8000 / share;
const closedSteps = 4000 / share;
const settings = { radius: 1.2, toolRadius: 0.5, margin: 0.2, maxStep: 0.8, guides: [] };

/** Returns a generator of numbers from 0 to 1, the same in each run. */
function seeded(state) {
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** Returns the corners in a binary STL file, nine numbers for each triangle. */
function trianglesOf(file) {
  const bytes = readFileSync(file);
  const count = bytes.readUInt32LE(80);
  return Array.from({ length: count }, (_, t) =>
    Array.from({ length: 9 }, (_, i) => bytes.readFloatLE(84 + 50 * t + 12 + 4 * i)),
  );
}

/** Returns the file of a sample mesh in the cache, and makes it if it is missing. */
function fixture(name) {
  const file = join(fixtures, `${name}.stl`);
  if (!existsSync(file)) execFileSync(command, ["inspect", name], { stdio: "ignore" });
  return file;
}

/** Writes the triangles as text. Returns the file. */
function asText(triangles, name) {
  const file = join(scratch, `${name}.obj`);
  const vertices = triangles.flatMap((t) =>
    [0, 3, 6].map((i) => `v ${t[i]} ${t[i + 1]} ${t[i + 2]}`),
  );
  const faces = triangles.map((_, t) => `f ${3 * t + 1} ${3 * t + 2} ${3 * t + 3}`);
  writeFileSync(file, `${vertices.join("\n")}\n${faces.join("\n")}\n`);
  return file;
}

/** Returns a random point of the surface and its normal. */
function placeOn(triangles, random) {
  for (;;) {
    const t = triangles[Math.floor(random() * triangles.length)];
    const [a, b] = [3, 6].map((k) => [0, 1, 2].map((i) => t[k + i] - t[i]));
    const normal = [
      a[1] * b[2] - a[2] * b[1],
      a[2] * b[0] - a[0] * b[2],
      a[0] * b[1] - a[1] * b[0],
    ];
    const length = Math.hypot(...normal);
    if (!(length > 0)) continue;
    const [u, v] = [random(), random()].sort();
    return {
      at: [0, 1, 2].map((i) => t[i] + u * a[i] + (1 - v) * b[i]),
      normal: normal.map((x) => x / length),
    };
  }
}

const along = (from, way, length) => from.map((x, i) => x + length * way[i]);

/** Returns tips at about the required clearance, and increments into the surface. */
function openPoses(triangles, random) {
  return Array.from({ length: openSteps }, () => {
    const { at, normal } = placeOn(triangles, random);
    const tip = along(
      at,
      normal,
      settings.toolRadius + settings.margin + 0.3 * random() * random(),
    );
    const way = normal.map((n) => 1.2 * (random() - 0.5) - n);
    const length = (0.1 + 0.7 * random()) / Math.hypot(...way);
    return [...tip, ...way.map((x) => length * x)];
  });
}

/** Returns goals that go into the surface, along below it, and on to the next place. */
function closedPoses(triangles, random) {
  const poses = [];
  let reset;
  while (poses.length < closedSteps) {
    const { at, normal } = placeOn(triangles, random);
    const start = along(at, normal, 4);
    reset ??= start;
    const aside = normal.map(() => random() - 0.5);
    for (let i = 0; i < 100; ++i) {
      const goal = along(
        along(start, normal, -Math.min(6, 0.15 * i)),
        aside,
        0.06 * Math.max(0, i - 40),
      );
      poses.push([...goal.map((x) => x + 0.02 * (random() - 0.5)), ...reset]);
    }
  }
  return poses.slice(0, closedSteps);
}

/** Returns the triangle count of a step if it is the same on every processor, else 0. */
const comparable = (rule, triangles) => (rule === "certified" ? 0 : triangles);

/** Returns the rows of a CSV file without its heading. */
function rowsOf(file) {
  return readFileSync(file, "latin1")
    .trimEnd()
    .split("\n")
    .slice(1)
    .map((line) => line.split(","));
}

/** Returns the native result of each step: its status, and its numbers with those of its planes. */
function native(mesh, rule, loop, poses) {
  const file = (name) => join(scratch, name);
  const [steps, planes] = [file("steps.csv"), file("planes.csv")];
  writeFileSync(file("poses.txt"), `${poses.map((pose) => pose.join(" ")).join("\n")}\n`);
  const options = {
    ...{ poses: file("poses.txt"), out: steps, planes, activation: rule },
    ...{ radius: settings.radius, "tool-radius": settings.toolRadius, margin: settings.margin },
    ...(loop === "closed" ? { "max-step": settings.maxStep } : {}),
  };
  const words = Object.entries(options).flatMap(([name, value]) => [`--${name}`, value]);
  if (loop === "closed") words.push("--closed-loop");
  execFileSync(command, ["replay", mesh, ...words], { stdio: ["ignore", "ignore", "inherit"] });
  const told = rowsOf(steps).map((row) => ({
    status: row[1],
    planes: Number(row[12]),
    numbers: [
      ...row.slice(2, 5),
      ...row.slice(8, 11),
      comparable(rule, row[11]),
      row[17] || NaN,
    ].map(Number),
  }));
  for (const [step, ...plane] of rowsOf(planes)) told[step].numbers.push(...plane.map(Number));
  return told;
}

/** Returns the result of a cycle, in the order of native(), with all planes. */
function toldBy(rule, tool, cycle, tip) {
  const { distance, motion, planeCount } = cycle;
  const numbers = [...tip, ...motion, comparable(rule, cycle.triangles), distance];
  for (const { triangle, normal, offset } of tool.made.planes()) {
    numbers.push(triangle, ...normal, offset);
  }
  return { status: statuses[cycle.status].name, planes: planeCount, numbers };
}

/** Returns the results of the module for the same poses. */
function byModule(tool, rule, loop, poses) {
  let tip = tool.place(poses[0].slice(3)).positions;
  return poses.map((pose) => {
    if (loop === "open") return toldBy(rule, tool, tool.step(pose), pose.slice(0, 3));
    const cycle = tool.follow({ place: pose.slice(0, 3), turn: [0, 0, 0, 1] });
    const told = toldBy(rule, tool, cycle, tip);
    tip = cycle.positions;
    return told;
  });
}

/** Returns the number of steps that differ. */
function differences(one, other) {
  assert.equal(one.length, other.length);
  const isSame = (a, b) =>
    a.status === b.status &&
    a.planes === b.planes &&
    a.numbers.length === b.numbers.length &&
    a.numbers.every((x, i) => Object.is(x, b.numbers[i]));
  return one.filter((told, step) => !isSame(told, other[step])).length;
}

const total = { steps: 0, limited: 0, planes: 0, different: 0 };
let isAwake = false; // true once the test has noticed a changed margin
for (const name of ["skull", "aneurysm", "airway"]) {
  const file = fixture(name);
  const triangles = trianglesOf(file);
  const mesh = name === "airway" ? asText(triangles, name) : file;
  const anatomy = keepout.anatomyOfFile(`${name}${mesh.slice(-4)}`, readFileSync(mesh));
  const random = seeded(triangles.length);
  const loops = { open: openPoses(triangles, random), closed: closedPoses(triangles, random) };
  for (const rule of ["all_faces", "paper", "certified"]) {
    const tool = new Tool(keepout, anatomy, { ...settings, rule }, null);
    for (const [loop, poses] of Object.entries(loops)) {
      const expected = native(mesh, rule, loop, poses);
      const different = differences(expected, byModule(tool, rule, loop, poses));
      const limited = expected.filter((told) => told.status === "limited").length;
      const planes = expected.reduce((sum, told) => sum + told.planes, 0);
      console.log(
        `${name} ${rule} ${loop}: ${poses.length} steps, ${limited} limited, ${planes} planes, ${different} different`,
      );
      total.steps += poses.length;
      total.limited += limited;
      total.planes += planes;
      total.different += different;
      if (!isAwake) {
        const margin = settings.margin * (1 + 1e-12);
        const other = new Tool(keepout, anatomy, { ...settings, rule, margin }, null);
        isAwake = differences(expected, byModule(other, rule, loop, poses)) > 0;
        other.made.delete();
      }
    }
    tool.made.delete();
  }
  anatomy.delete();
}
console.log(
  `in all: ${total.steps} steps, ${total.limited} limited, ${total.planes} planes, ${total.different} different`,
);
assert.equal(total.steps, 108e3 / share);
assert(
  3 * total.limited >= total.steps,
  "fewer than a third of the steps were limited: the test is too easy",
);
assert(total.planes >= total.limited, "planes were not compared");
assert(isAwake, "the test did not notice a margin that is larger by a factor of 1 + 1e-12");
assert.equal(total.different, 0, "native keepout and the module differ");
