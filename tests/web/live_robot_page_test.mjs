// SPDX-License-Identifier: BSD-3-Clause
/**
 * The page of `keepout live --robot`, in a real browser and with real input:
 *
 *   live_robot_page_test.mjs KEEPOUT JUDGE_INSTRUMENT_PATH FOLDER [BROWSER]
 *
 * A hand drags the jaw of an instrument into the skull and about in it; what its joints did is
 * judged by the oracle of `keepout verify --robot`, whose kinematics and distances are its own.
 * Then it is turned, led by keys and by touch. Prints times and rates, and asserts none.
 */
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import {
  assertReplayed,
  dragged,
  handAt,
  limitedCycles,
  livePage,
  noteRates,
  savedPath,
  skull,
  testLooks,
  textOf,
} from "./live_tab.mjs";
import { large, note, sleep, small } from "./tabs.mjs";

const { judge, folder, run, open } = await livePage("--robot", "psm");

/** What the judge says of a path. */
const judged = (path) => JSON.parse(run(judge, skull, path));

/** Takes the jaw, leads it down the view into the anatomy, and about there; holds it. */
const dragIn = (tab, seconds = 6) =>
  dragged(tab, seconds, (t) => [90 * Math.sin(9 * t), 260 * Math.min(1, 3 * t)]);

/** Waits until the instrument was held back in so many cycles; a browser may be slow. */
async function comesTo(tab, cycles) {
  for (let i = 0; i < 200 && (await limitedCycles(tab)) < cycles; ++i) await sleep(50);
  assert.ok((await limitedCycles(tab)) >= cycles, "it is not led into the skull");
}

let desk; // the page that most tests go on with
let phone;

test("the jaw dragged into the skull: held back, and all bodies clear, says the judge", async () => {
  desk = await open(large);
  await dragIn(desk);
  assert.equal(await textOf(desk, "#status b"), "limited");
  assert.match(await textOf(desk, "#status span"), /limit the motion/);
  assert.match(await textOf(desk, "#held"), /^by the (shaft|wrist|jaw)$/);
  assert.match(await textOf(desk, "#clearance"), /^0\.2\d mm$/);
  await desk.screenshot({ path: join(folder, "dragged.png") });
  await desk.mouse.up();
  await noteRates(desk);
  const path = await savedPath(desk, folder);
  const verdict = judged(path);
  note(JSON.stringify(verdict));
  const { jumps, below, in_mesh, limits } = verdict;
  assert.deepEqual([jumps, below, in_mesh, limits], [0, 0, 0, 0]);
  assert.ok(verdict.way > 20, `the jaw went ${verdict.way} mm only`);
  assert.ok(verdict.held >= 500, `held back in ${verdict.held} cycles only`);
  assert.ok(verdict.nearest !== null && verdict.nearest >= verdict.kept - 1e-9);

  // That judge sees what is too close: had the margin been larger, it would say so.
  const text = readFileSync(join(folder, path), "utf8");
  const { margin } = JSON.parse(text.match(/^# path: (.*)$/m)[1]);
  writeFileSync(
    join(folder, "stricter.txt"),
    text.replace(`"margin":${margin}`, `"margin":${margin + 0.3}`),
  );
  assert.ok(judged("stricter.txt").below > 0, "the judge sees nothing");
});

test("it is turned by the wheel and by keys, and the hand with it", async () => {
  await desk.click("#again");
  await sleep(700);
  const { x, y } = await handAt(desk);
  await desk.mouse.move(x, y);
  await desk.mouse.down();
  await desk.keyboard.down("Shift");
  for (let i = 0; i < 20; ++i) await desk.mouse.wheel({ deltaY: 10 });
  await desk.keyboard.up("Shift");
  await sleep(500);
  await desk.keyboard.down("d");
  await sleep(300);
  await desk.keyboard.up("d");
  await sleep(500);
  await desk.mouse.up();
  const turned = judged(await savedPath(desk, folder));
  note(JSON.stringify(turned));
  assert.ok(turned.turn > 0.5, `turned by ${turned.turn} rad only`);
  assert.deepEqual([turned.jumps, turned.below, turned.limits], [0, 0, 0]);
});

test("led by keys, into the skull and out of hand", async () => {
  await desk.click("#again");
  await sleep(300);
  const before = await limitedCycles(desk);
  await desk.focus("#view");
  await desk.keyboard.down("ArrowDown");
  await comesTo(desk, before + 100);
  await desk.keyboard.up("ArrowDown");
  assert.doesNotMatch(await textOf(desk, "#hand-off"), /^0\.00 mm/);
  await desk.keyboard.press("Escape");
  await desk.waitForFunction(() =>
    document.querySelector("#hand-off").textContent.startsWith("0.00 mm"),
  );
});

test("a wider margin is come up to, and kept", async () => {
  await desk.$eval("#margin", (slider) => {
    slider.value = "1";
    slider.dispatchEvent(new Event("input"));
  });
  await desk.waitForFunction(
    () => Number.parseFloat(document.querySelector("#clearance").textContent) > 0.99,
  );
  await dragIn(desk, 2);
  await desk.waitForFunction(() =>
    /^(1\.|0\.99)/.test(document.querySelector("#clearance").textContent),
  );
  await desk.mouse.up();
  const verdict = judged(await savedPath(desk, folder));
  note(JSON.stringify(verdict));
  assert.deepEqual([verdict.jumps, verdict.below, verdict.limits], [0, 0, 0]);
});

test("a path is played again, the same in every bit", async () => {
  await desk.click("#replay");
  await assertReplayed(desk);
});

test("led by touch, on a phone, and turned by a second finger", async () => {
  phone = await open(small);
  const { x, y } = await handAt(phone);
  const finger = await phone.touchscreen.touchStart(x, y);
  for (let i = 0; i < 50; ++i) {
    await finger.move(x, y + 3 * i);
    await sleep(20);
  }
  await comesTo(phone, 100);
  const second = await phone.touchscreen.touchStart(x + 60, y);
  for (let i = 0; i < 30; ++i) await second.move(x + 60 + 5 * i, y);
  await sleep(500);
  await second.end();
  await finger.end();
  const verdict = judged(await savedPath(phone, folder));
  note(JSON.stringify(verdict));
  assert.ok(verdict.turn > 0.1, `turned by ${verdict.turn} rad only`);
  assert.deepEqual([verdict.jumps, verdict.below, verdict.limits], [0, 0, 0]);
});

testLooks(folder, () => ({ desk, phone }));
