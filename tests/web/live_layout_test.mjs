// SPDX-License-Identifier: BSD-3-Clause
/**
 * Tests what a page of `keepout live` shows before anyone touches it: its layout in windows of many sizes, and
 * the start of the tool beside every sample mesh:
 *
 *   live_layout_test.mjs KEEPOUT FOLDER
 *
 * All tests use one page. Meshes of real anatomy are tested if ./run has prepared them; the large ones only with
 * ./test --long.
 */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readdirSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import {
  bonePixels,
  empty,
  firefoxLong,
  isLong,
  launched,
  note,
  opened,
  root,
  sleep,
  textOf,
} from "./tabs.mjs";

const [keepout, folder] = process.argv.slice(2);
const sizes = [
  "1920x1080",
  "1280x800",
  "1280x600",
  "1024x600",
  "768x1024",
  "390x844",
  "360x640",
  "844x390",
];
/** The part of the view between the cards. */
const middle = { x: 320, y: 20, width: 640, height: 760 };
const sizeOf = (text) => {
  const [width, height] = text.split("x").map(Number);
  return { width, height };
};

empty(folder);
const cube = join(root, "tests/install/cube.obj");
execFileSync(keepout, ["live", cube, "--no-open", "--out", "page.html"], { cwd: folder });
const browser = await launched();
after(() => browser.close());
const tab = await opened(browser, join(folder, "page.html"), sizeOf("1280x800"));

/** Waits until the page shows this mesh and a tool beside it. */
const ready = (name) =>
  tab.waitForFunction(
    (title) =>
      document.title.startsWith(title) &&
      !document.querySelector("#grip").hidden &&
      document.querySelector("#loading").hidden &&
      document.querySelector("#clearance").textContent.endsWith("mm"),
    { timeout: 60_000 },
    name,
  );

/** Returns the faults of the layout: overlapping cards, content outside of its card, a covered grip. */
const faultsOfLayout = () =>
  tab.evaluate(() => {
    const faults = [];
    const cards = [...document.querySelectorAll(".card")];
    const boxes = cards.map((card) => card.getBoundingClientRect());
    cards.forEach((card, i) => {
      const scrolls = getComputedStyle(card).overflowY === "auto";
      if (!scrolls && card.scrollHeight > card.clientHeight + 1)
        faults.push(`${card.id} is too low`);
      if (card.scrollWidth > card.clientWidth + 1) faults.push(`${card.id} is too narrow`);
      for (let k = 0; k < i; ++k) {
        const [a, b] = [boxes[i], boxes[k]];
        const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
        if (across > 0 && down > 0) faults.push(`${card.id} overlaps ${cards[k].id}`);
      }
    });
    if (document.documentElement.scrollWidth > innerWidth) faults.push("the page scrolls sideways");
    const { x, y, width, height } = document.querySelector("#grip").getBoundingClientRect();
    const on = document.elementFromPoint(x + width / 2, y + height / 2);
    if (!document.querySelector("#view").contains(on)) faults.push(`the grip is under ${on?.id}`);
    return faults;
  });

test("no card covers another one or the hand, in eight windows", async () => {
  await ready("cube.obj");
  for (const size of sizes) {
    await tab.setViewport(sizeOf(size));
    await sleep(300);
    assert.deepEqual(await faultsOfLayout(), [], size);
    await tab.$$eval("details", (all) => {
      for (const one of all) one.open = true;
    });
    await sleep(100);
    assert.deepEqual(await faultsOfLayout(), [], `${size}, all details open`);
    await tab.$$eval("details", (all) => {
      for (const one of all) one.open = false;
    });
  }
  await tab.setViewport(sizeOf("1280x800"));
});

/** Asserts that the tool begins free, outside the required clearance, and in sight. */
async function assertStart(name) {
  await ready(name);
  await sleep(250);
  const [status, clearance, limited, margin] = await Promise.all(
    ["#status b", "#clearance", "#limited", "#margin-kept"].map((where) => textOf(tab, where)),
  );
  assert.equal(status, "free", name);
  assert.equal(limited.split(" of ")[0], "0", `${name}: the tool began with a retreat`);
  const [here, kept] = [clearance, margin].map(Number.parseFloat);
  assert.ok(here > kept, `${name}: ${clearance} from the surface, with a margin of ${margin}`);
  assert.deepEqual(await faultsOfLayout(), [], name);
  assert.ok(
    await tab.$eval("#find", (button) => button.hidden),
    `${name}: the tool is out of sight`,
  );
}

test("the tool begins free and in sight beside every generated mesh", firefoxLong, async () => {
  const names = await tab.$$eval('#mesh optgroup[label="Generated"] option', (all) =>
    all.map((one) => [one.value, one.textContent]),
  );
  assert.ok(names.length >= 18);
  for (const [value, name] of names) {
    await tab.select("#mesh", value);
    await assertStart(name);
  }
});

test("the tool begins free and in sight beside the anatomies", firefoxLong, async () => {
  const fixtures = join(process.env.KEEPOUT_CACHE || join(root, ".cache"), "fixtures");
  const files = existsSync(fixtures)
    ? readdirSync(fixtures).filter((name) => name.endsWith(".stl"))
    : [];
  const field = await tab.$("#file");
  for (const name of files) {
    if (!isLong && statSync(join(fixtures, name)).size > 5e6) continue;
    await field.uploadFile(join(fixtures, name));
    await assertStart(name);
    note(`${name}: ${await textOf(tab, "#clearance")}`);
  }
});

test("a mesh in meters is seen, and scaled by a button", async () => {
  const octahedron = ["1 0 0", "-1 0 0", "0 1 0", "0 -1 0", "0 0 1", "0 0 -1"]
    .map((line) => `v ${line.replaceAll("1", "0.08")}`)
    .concat(
      ["1 3 5", "3 2 5", "2 4 5", "4 1 5", "3 1 6", "2 3 6", "4 2 6", "1 4 6"].map((f) => `f ${f}`),
    );
  writeFileSync(join(folder, "meters.obj"), `${octahedron.join("\n")}\n`);
  await (await tab.$("#file")).uploadFile(join(folder, "meters.obj"));
  await ready("meters.obj");
  await sleep(500);
  assert.ok((await bonePixels(tab, middle)) > 500, "the mesh is not drawn");
  assert.match(await textOf(tab, "#toast"), /0\.16 mm across.*meters/);
  await tab.click("#toast button");
  await assertStart("meters.obj × 1000");
  assert.match(await textOf(tab, "#findings"), /160/);
});

/** Returns the middle of the grip. */
const handAt = () =>
  tab.$eval("#grip", (grip) => {
    const { x, y, width, height } = grip.getBoundingClientRect();
    return { x: x + width / 2, y: y + height / 2 };
  });

test("a drag off the window keeps hand and tool in the open view", async () => {
  const { x, y } = await handAt();
  await tab.mouse.move(x, y);
  await tab.mouse.down();
  await tab.mouse.move(1279, 5, { steps: 4 });
  await sleep(500);
  assert.deepEqual(await faultsOfLayout(), []);
  await tab.mouse.up();
  await sleep(300);
  assert.deepEqual(await faultsOfLayout(), []);
  assert.ok(await tab.$eval("#find", (button) => button.hidden));
});

test("the hand stays while a rule is chosen, and the inside is red", async () => {
  await tab.click("#again");
  await sleep(500);
  const { x, y } = await handAt();
  await tab.mouse.move(x, y);
  await tab.mouse.down();
  await tab.mouse.move(x - 150, y, { steps: 20 });
  await sleep(500);
  const held = Number.parseFloat(await textOf(tab, "#newtons"));
  assert.ok(held > 1, `the hand pulls by ${held} N`);
  await tab.keyboard.press("1");
  await tab.waitForFunction(() =>
    document.querySelector("#clearance").textContent.startsWith("\u2212"),
  );
  assert.equal(await tab.$eval("#status", ({ className }) => className), "stopped");
  assert.equal(await textOf(tab, "#status b"), "inside");
  await tab.keyboard.press("4");
  await sleep(1500);
  assert.ok(!(await textOf(tab, "#clearance")).startsWith("\u2212"));
  assert.ok(Number.parseFloat(await textOf(tab, "#newtons")) > 1, "the hand was dropped");
  await tab.mouse.up();
});

test("a lost WebGL context is reported, and drawn again", async () => {
  const before = await bonePixels(tab, middle);
  const lose = await tab.evaluateHandle(() => {
    const context = document.querySelector("#picture").getContext("webgl2");
    return context.getExtension("WEBGL_lose_context");
  });
  await lose.evaluate((one) => one.loseContext());
  await tab.waitForFunction(() =>
    document.querySelector("#loading").textContent.includes("graphics"),
  );
  assert.ok(!(await tab.$eval("#loading", (line) => line.hidden)));
  await lose.evaluate((one) => one.restoreContext());
  await tab.waitForFunction(() => document.querySelector("#loading").hidden);
  await sleep(700);
  const after = await bonePixels(tab, middle);
  assert.ok(after > 0.9 * before, `${before} pixels of bone before, ${after} after`);
});

test("nothing was complained of", () => {
  assert.deepEqual(
    tab.faults.filter((fault) => !/context/i.test(fault)),
    [],
  );
});
