// SPDX-License-Identifier: BSD-3-Clause
/**
 * Tests the two scenes of `keepout live` in a browser:
 *
 *   live_sides_test.mjs KEEPOUT JUDGE_PATH FOLDER
 *
 * A stroke is played to both tools, and both paths are saved. Both must have bitwise the same hand in each cycle.
 * The exact oracle must find that the tool under the rule of Li et al. (2020) goes through the wall, and that the
 * certified one keeps its required clearance. The stroke over the aneurysm is tested if ./run has prepared it. There,
 * `keepout replay` must repeat both paths bit for bit. The tunnel's vertices come from the C library's sine.
 */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import { differing, linesOf, replayedPath, stepsText } from "./paths.mjs";
import {
  assertAccessible,
  empty,
  launched,
  note,
  opened,
  root,
  sleep,
  small,
  textOf,
} from "./tabs.mjs";

const [keepout, judge, folder] = process.argv.slice(2);
const aneurysm = join(process.env.KEEPOUT_CACHE || join(root, ".cache"), "fixtures/aneurysm.stl");
// Software draws a small view faster.
const wide = { width: 960, height: 600 };
empty(folder);
const run = (program, ...args) => execFileSync(program, args, { encoding: "utf8", cwd: folder });
const browser = await launched(folder);
after(() => browser.close());
let tab;

async function openPage(mesh, viewport) {
  const page = `page_${viewport.width}.html`;
  run(keepout, "live", mesh, "--no-open", "--out", page);
  tab = await opened(browser, join(folder, page), viewport);
  await tab.waitForFunction(
    () =>
      !document.querySelector("#grip").hidden &&
      document.querySelector("#clearance").textContent.endsWith("mm"),
    { timeout: 150_000 },
  );
}

/** Returns the texts above the two scenes. */
const heads = () =>
  tab.$$eval("#sides .side", (sides) =>
    sides.map((side) =>
      [".chip", ".gap"].map((part) => side.querySelector(part).textContent).join("; "),
    ),
  );

/** Waits until both scenes show a distance. */
const bothRun = () =>
  tab.waitForFunction(
    () =>
      [...document.querySelectorAll("#sides .gap")].every(({ textContent }) =>
        textContent.includes("mm"),
      ),
    { timeout: 150_000 },
  );

/** Returns the section in each scene: its magnification, and if the place beside and above the point is solid. */
const sections = () =>
  tab.$$eval("#sides .side", (sides) => {
    const gaps = sides.map((side) => Number.parseFloat(side.querySelector(".gap").textContent));
    return sides.map((side, i) => {
      const { width, height } = side.querySelector("canvas");
      const pen = side.querySelector("canvas").getContext("2d");
      const y =
        height / 2 + (((i === 0 ? 0.2 : -0.2) * gaps[i]) / Math.max(...gaps) - 0.07) * width;
      const [, , , opacity] = pen.getImageData(0.3 * width, y, 1, 1).data;
      return { times: side.querySelector("figcaption b").textContent, isSolid: opacity > 0 };
    });
  });

/** Saves both paths of a mesh. Returns them: that of the rule of Li et al., and the certified one. */
async function savedPaths(mesh) {
  await tab.$eval("#sides-save", (button) => button.click()); // on a phone it is not shown
  const paths = ["paper", "certified"].map((rule) => `keepout-path-${mesh}-${rule}.txt`);
  for (let i = 0; i < 300 && !paths.every((file) => existsSync(join(folder, file))); ++i) {
    await sleep(50);
  }
  await sleep(300);
  return paths.map((file) => ({ file, text: readFileSync(join(folder, file), "utf8") }));
}

/** Judges the motions of a path: see judge_path.cpp. */
function judged(mesh, name, lines, kept) {
  writeFileSync(join(folder, `${name}.csv`), stepsText(lines));
  const verdict = JSON.parse(run(judge, mesh, `${name}.csv`, String(kept)));
  note(`${name}: ${JSON.stringify(verdict)}`);
  return verdict;
}

/** Plays the stroke of a page, and judges both sides. Returns both paths. `mesh`: the file for the judge. */
async function testStroke(name, mesh) {
  await tab.$eval("#sides-play", (button) => button.click());
  await tab.waitForFunction(
    () => document.querySelector("#sides-words").textContent.includes("adds no plane"),
    { timeout: 120_000 },
  );
  assert.match((await heads())[0], /^went through the wall; /);
  assert.match((await heads())[1], /^limited; 0\.20 mm/);
  await tab.click("#sides-pause");
  await tab.screenshot({ path: join(folder, `${name}.png`) });
  const [paper, certified] = await savedPaths(name);

  const [left, right] = [paper, certified].map(linesOf);
  const cycles = Math.min(left.length, right.length);
  const differ = (from) => (line, i) =>
    line.slice(from, from + 3).some((value, k) => !Object.is(value, right[i][from + k]));
  note(`${left.length} and ${right.length} cycles`);
  assert.ok(cycles > 3000);
  assert.equal(left.slice(0, cycles).filter(differ(0)).length, 0, "the hands differ");
  assert.ok(left.slice(0, cycles).some(differ(3)), "the tools do not differ");

  const { settings } = JSON.parse(paper.text.match(/^# path: (.*)$/m)[1]);
  const kept = settings.toolRadius + settings.margin;
  const through = judged(mesh, "paper", left, kept);
  assert.ok(through.crossing > 0, "the tool under Li et al.’s rule does not go through the wall");
  const safe = judged(mesh, "certified", right, kept);
  assert.deepEqual([safe.crossing, safe.nearer], [0, 0]);
  assert.ok(safe.nearest !== null && safe.nearest < kept + 0.01, "it never came to the margin");
  return { paper, certified };
}

test("two scenes by keys: both tools follow, and the left one has no fixture", async () => {
  await openPage(join(root, "tests/install/cube.obj"), wide);
  await tab.focus("#compare");
  await tab.keyboard.press("Enter");
  await bothRun();
  assert.ok(!(await tab.$eval("#other-grip", ({ hidden }) => hidden)));
  await tab.focus("#view");
  await tab.keyboard.press("1");
  assert.equal(await tab.$eval("#sides-rule", ({ value }) => value), "none");
  await tab.keyboard.down("ArrowLeft");
  await tab.waitForFunction(
    () => {
      const parts = [...document.querySelectorAll("#sides :is(.chip, .gap)")];
      const words = parts.map(({ textContent }) => textContent).join();
      return /^inside,−.*,limited,0\.20 mm/.test(words);
    },
    { timeout: 150_000 },
  );
  await tab.keyboard.up("ArrowLeft");
  await tab.keyboard.press("Escape");
  await tab.keyboard.press("3");
});

test("a stroke through the wall of a tube: one hand, and the judge agrees", async () => {
  run(keepout, "convert", "tunnel", "tunnel.stl");
  await testStroke("tunnel", "tunnel.stl");
});

test("counterexamples: the rule of Li et al. goes through, the certified one stays out", async () => {
  const box = await tab.$eval("#sides", (one) => {
    const { x, y, width, height } = one.getBoundingClientRect();
    return { x, y, width, height };
  });
  const picture = () => tab.screenshot({ encoding: "base64", clip: box });
  const names = await tab.$$eval("#sides-show optgroup option", (all) =>
    all.map(({ value }) => value),
  );
  assert.equal(names.length, 3);
  await tab.$eval("#fail", (button) => button.click());
  await tab.waitForFunction(
    () => document.querySelector("#sides .chip").textContent === "goes through the surface",
  );
  assert.equal(await tab.$eval("#sides-show", ({ value }) => value), "CE5_closed_octahedron");
  for (const name of names) {
    await tab.select("#sides-show", name);
    await tab.waitForFunction(
      () => document.querySelector("#sides .chip").textContent === "goes through the surface",
    );
    const [left, right] = await heads();
    assert.match(left, /^goes through the surface; −?\d\.\d{3} mm/);
    assert.match(right, /^stays out; \d\.\d{3} mm/);
    assert.match(await textOf(tab, "#sides-words"), /asks for \d\.\d\d mm .* margin of 0\.001 mm/);
    const [through, out] = await sections();
    assert.equal(through.times, out.times);
    assert.deepEqual([through.isSolid, out.isSolid], [true, false], name);
    await tab.screenshot({ path: join(folder, `${name}.png`) });
  }
  // In motion, no result is shown before the tool has arrived.
  await tab.emulateMediaFeatures([{ name: "prefers-reduced-motion", value: "no-preference" }]);
  await tab.waitForFunction(
    () =>
      [...document.querySelectorAll("#sides .chip")].every(
        (chip) => chip.textContent === "moving",
      ) && [...document.querySelectorAll("#sides .magnifier")].every(({ hidden }) => hidden),
  );
  await tab.emulateMediaFeatures([{ name: "prefers-reduced-motion", value: "reduce" }]);
  await tab.waitForSelector("#sides .magnifier:not([hidden])");
  const before = await picture();
  await tab.mouse.move(box.x + 100, box.y + 200);
  await tab.mouse.down();
  await tab.mouse.move(box.x + 180, box.y + 230, { steps: 4 });
  await tab.mouse.up();
  await sleep(300);
  assert.notEqual(await picture(), before, "a drag does not turn the scenes");
  await tab.click("#sides-pause");
  assert.equal(await textOf(tab, "#sides-pause"), "Play");
  await tab.select("#sides-show", "hand");
  await bothRun();
});

for (const scheme of ["light", "dark"]) {
  test(`controls have names and contrast holds: ${scheme}`, () => assertAccessible(tab, scheme));
}

test("one scene again: the anatomy and the settings of before", async () => {
  await tab.focus("#sides-close");
  await tab.keyboard.press("Enter");
  await tab.waitForFunction(() => document.title.startsWith("cube.obj"), { timeout: 30_000 });
  assert.ok(await tab.$eval(".column", (one) => one.checkVisibility()));
  assert.deepEqual(tab.faults, []);
  await tab.close();
});

test("a stroke through the wall of an aneurysm, on a phone", async (context) => {
  if (!existsSync(aneurysm)) {
    context.skip("./run has not prepared the aneurysm");
    return;
  }
  await openPage(aneurysm, small);
  const paths = await testStroke("aneurysm.stl", aneurysm);
  for (const [rule, path] of Object.entries(paths)) {
    const rows = replayedPath(keepout, folder, path, aneurysm, rule);
    assert.equal(differing(linesOf(path), rows), 0, rule);
  }
  const boxes = await tab.$$eval("#sides .side, #sides-bar", (all) =>
    all.map((one) => one.getBoundingClientRect().top),
  );
  assert.ok(boxes[0] < boxes[1] - 200 && boxes[1] < boxes[2] - 200, `tops at ${boxes}`);
  assert.ok(await tab.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  assert.deepEqual(tab.faults, []);
});
