// SPDX-License-Identifier: BSD-3-Clause
/**
 * Tests how a page of `keepout live` shows the margin, and how it chooses the quality of the picture:
 *
 *   live_margin_test.mjs KEEPOUT FOLDER
 *
 * The tool is pressed on a cube. The callout must have the engine's clearance. Modules of the page that need no
 * browser are tested alone.
 */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { after, test } from "node:test";
import { pathToFileURL } from "node:url";
import { empty, launched, note, opened, packages, root, sleep, textOf } from "./tabs.mjs";

const [keepout, folder] = process.argv.slice(2);
empty(folder);
const file = join(root, "tests/install/cube.obj");
execFileSync(keepout, ["live", file, "--no-open", "--out", "page.html"], { cwd: folder });
const browser = await launched();
after(() => browser.close());
const tab = await opened(browser, join(folder, "page.html"), { width: 1000, height: 640 });

/** Returns a module of the pages. */
async function moduleOf(name) {
  const outfile = join(folder, `${name}.mjs`);
  await packages("esbuild").build({
    entryPoints: [join(root, `apps/web/src/page/${name}.ts`)],
    ...{ bundle: true, format: "esm", outfile, logLevel: "silent" },
    nodePaths: [join(root, "apps/web/node_modules")],
  });
  return import(pathToFileURL(outfile).href);
}

test("the picture becomes lighter if frames are slow, and finer again", async () => {
  const { PictureQuality } = await moduleOf("picture_quality");
  const quality = new PictureQuality(0);
  /** Draws so many times 24 frames, and returns the quality. */
  const after = (batches, time) => {
    for (let i = 0; i < 24 * batches; ++i) quality.add(time);
    return quality.quality.name;
  };
  assert.equal(after(100, 16.7), "full");
  for (let i = 0; i < 10; ++i) quality.add(60);
  for (let i = 0; i < 14; ++i) quality.add(16.7);
  assert.equal(quality.quality.name, "full", "a few slow frames do not count");
  assert.equal(after(1, 40), "light");
  assert.equal(after(1, 40), "lightest");
  assert.equal(after(20, 40), "lightest");
  assert.equal(after(20, 16.7), "lightest", "8 s are not enough for a finer picture");
  assert.equal(after(5, 16.7), "light");
  // A trial that is too slow is not repeated soon.
  assert.equal(after(1, 40), "lightest");
  assert.equal(after(40, 16.7), "lightest");
  assert.equal(after(11, 16.7), "light");
  assert.equal(after(100, 16.7), "full");
  for (let i = 0; i < 24; ++i) quality.add(60_000);
  assert.equal(quality.quality.name, "full", "a page that was hidden is not slow");
  const software = new PictureQuality(1);
  for (let i = 0; i < 10_000; ++i) software.add(16.7);
  assert.equal(software.quality.name, "light");
});

/** A cube of side 2, of which each side has 2 n² triangles. */
function cube(n) {
  const [positions, corners] = [[], []];
  for (let axis = 0; axis < 3; ++axis) {
    for (const side of [-1, 1]) {
      const first = positions.length / 3;
      for (let i = 0; i <= n; ++i) {
        for (let k = 0; k <= n; ++k) {
          const place = [side, (2 * i) / n - 1, (2 * k) / n - 1];
          positions.push(...[0, 1, 2].map((at) => place[(at - axis + 3) % 3]));
        }
      }
      for (let i = 0; i < n; ++i) {
        for (let k = 0; k < n; ++k) {
          const [a, b] = [first + i * (n + 1) + k, first + (i + 1) * (n + 1) + k];
          const two = [a, b, b + 1, a, b + 1, a + 1];
          corners.push(...(side > 0 ? two : two.toReversed()));
        }
      }
    }
  }
  return { positions: new Float32Array(positions), corners: new Uint32Array(corners) };
}

test("the nearest point of a surface is found", async () => {
  const { NearTriangles } = await moduleOf("nearest");
  const { positions, corners } = cube(9);
  const near = new NearTriangles(positions, corners);
  const clamp = (value) => Math.min(Math.max(value, -1), 1);
  const vector = (x, y, z) => ({ x, y, z });
  for (let i = 0; i < 200; ++i) {
    const [x, y, z] = [0, 1, 2].map((k) => 3 * Math.sin(7.3 * i + 2.1 * k ** 2));
    if (Math.max(...[x, y, z].map(Math.abs)) < 1) continue;
    const found = near.nearest(vector(x, y, z));
    [x, y, z].forEach((value, axis) => {
      const coordinate = found.point.getComponent(axis);
      assert.ok(Math.abs(coordinate - clamp(value)) < 1e-6, `${[x, y, z]}`);
    });
  }
});

test("shading moves no vertex; smooth surfaces have steady normals, and hollows are dark", async () => {
  const { shade } = await moduleOf("shading");
  /** Returns the shading of spheres with steps, like those of a scan. */
  const shaded = (shells, creases) => {
    const [positions, corners] = [[], []];
    for (const [radius, sign] of shells) {
      const first = positions.length / 3;
      const ball = cube(24);
      for (let i = 0; i < ball.positions.length; i += 3) {
        const way = [...ball.positions.subarray(i, i + 3)];
        const length = Math.hypot(...way);
        const step = Math.floor(6 * (way[2] / length + 1)) % 2 === 0 ? 1 : 1.04;
        positions.push(...way.map((value) => (radius * step * value) / length));
      }
      const turned = sign > 0 ? ball.corners : ball.corners.toReversed();
      for (const corner of turned) corners.push(first + corner);
    }
    const surface = [new Float32Array(positions), new Uint32Array(corners)];
    const copies = surface.map((one) => one.slice());
    const work = shade(...surface, creases);
    let end = work.next();
    while (!end.done) end = work.next();
    surface.forEach((one, i) => {
      assert.ok(Buffer.from(one.buffer).equals(Buffer.from(copies[i].buffer)));
    });
    return { ...end.value, positions: surface[0] };
  };
  /** Returns the mean angle between the normals and those of a sphere. */
  const roughness = ({ normals, positions }) => {
    let sum = 0;
    for (let i = 0; i < normals.length; i += 3) {
      const [n, p] = [normals, positions].map((all) => all.subarray(i, i + 3));
      const along = n.reduce((all, value, k) => all + value * p[k], 0) / Math.hypot(...p);
      sum += Math.acos(Math.min(1, along));
    }
    return (3 * sum) / normals.length;
  };
  const smooth = shaded([[10, 1]], false);
  const [before, after] = [roughness(shaded([[10, 1]], true)), roughness(smooth)];
  assert.ok(after < 0.8 * before, `normals are ${before} rad off, and smoothed ${after}`);
  const mean = (bytes) => bytes.reduce((sum, one) => sum + one, 0) / bytes.length;
  const outer = mean(smooth.ambience);
  assert.ok(outer > 180, `a ball gets ${outer} of the light`);
  const within = [
    [10, 1],
    [12, -1],
  ];
  const inner = mean(shaded(within, false).ambience);
  assert.ok(inner < 0.7 * outer, `in a shell it gets ${inner}, and alone ${outer}`);
});

const isShown = (selector) => tab.$eval(selector, (one) => !one.hidden);

/** Returns the middle of the grip. */
const handAt = () =>
  tab.$eval("#grip", (grip) => {
    const { x, y, width, height } = grip.getBoundingClientRect();
    return { x: x + width / 2, y: y + height / 2 };
  });

test("callout and magnifier appear near the surface, with the engine's clearance", async () => {
  await tab.waitForFunction(
    () =>
      !document.querySelector("#grip").hidden &&
      document.querySelector("#clearance").textContent.endsWith("mm"),
    { timeout: 60_000 },
  );
  await sleep(500);
  const began = Number.parseFloat(await textOf(tab, "#clearance"));
  assert.equal(await isShown(".callout"), false, `shown at ${began} mm`);
  assert.equal(await isShown(".magnifier"), false);
  const { x, y } = await handAt();
  await tab.mouse.move(x, y);
  await tab.mouse.down();
  await tab.mouse.move(x - 120, y, { steps: 12 });
  await tab.waitForFunction(() => document.querySelector("#status b").textContent === "limited", {
    timeout: 20_000,
  });
  await sleep(1000);
  for (const part of [".callout", ".magnifier"]) assert.ok(await isShown(part), part);
  const [callout, clearance] = [await textOf(tab, ".callout"), await textOf(tab, "#clearance")];
  assert.equal(callout, `clearance ${clearance}`);
  assert.match(clearance, /^0\.2\d mm$/);
  assert.match(await textOf(tab, ".magnifier b"), /^\d+(\.\d)?×, margin 0\.20 mm$/);
  const painted = await tab.$eval(".magnifier canvas", (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return new Set(new Uint32Array(data.buffer)).size;
  });
  assert.ok(painted > 10, `the magnifier has ${painted} colors`);
  await tab.screenshot({ path: join(folder, "near.png") });
  await tab.mouse.up();
});

test("without a fixture the callout is red inside", async () => {
  await tab.keyboard.press("1");
  const { x, y } = await handAt();
  await tab.mouse.move(x, y);
  await tab.mouse.down();
  await tab.mouse.move(x - 60, y, { steps: 12 });
  await tab.waitForFunction(
    () => document.querySelector(".callout").textContent.includes("\u2212"),
    { timeout: 60_000 },
  );
  assert.equal(await tab.$eval(".callout", ({ className }) => className), "callout bad");
  await tab.mouse.up();
  await tab.keyboard.press("4");
});

test("a picture drawn by software is not the full one, and no fault was reported", async () => {
  const picture = await tab.$eval("#view", (view) => view.dataset.picture);
  note(`the picture is ${picture}, with ${await textOf(tab, "#frames")} frames a second`);
  assert.notEqual(picture, "full");
  assert.deepEqual(tab.faults, []);
});
