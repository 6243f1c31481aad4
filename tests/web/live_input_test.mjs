// SPDX-License-Identifier: BSD-3-Clause
/**
 * Tests that a page of `keepout live` can be used by keys, by two fingers and with a screen reader:
 *
 *   live_input_test.mjs KEEPOUT FOLDER
 */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { after, test } from "node:test";
import { bonePixels, empty, launched, opened, root, sleep, small, textOf } from "./tabs.mjs";

const [keepout, folder] = process.argv.slice(2);
empty(folder);
const cube = join(root, "tests/install/cube.obj");
execFileSync(keepout, ["live", cube, "--no-open", "--out", "page.html"], { cwd: folder });
const browser = await launched();
after(() => browser.close());
const tab = await opened(browser, join(folder, "page.html"), small, (page) =>
  // Keeps the last hand that the page has reported to the control loop: null if it is released.
  page.evaluateOnNewDocument(() => {
    window.hand = null;
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (message, ...rest) {
      if (message.kind === "hand") window.hand = message.hand;
      return post.call(this, message, ...rest);
    };
  }),
);
await tab.waitForFunction(
  () => !document.querySelector("#grip").hidden && document.querySelector("#loading").hidden,
  { timeout: 60_000 },
);

/** Returns the middle of the hand in the window. */
const handAt = () =>
  tab.$eval("#grip", (grip) => {
    const { x, y, width, height } = grip.getBoundingClientRect();
    return { x: x + width / 2, y: y + height / 2 };
  });

/** Waits until the hand is at another place in the window, because the view has moved. */
async function assertMoved(act, what) {
  const before = await handAt();
  await act();
  for (let i = 0; i < 100; ++i) {
    const { x, y } = await handAt();
    if (Math.hypot(x - before.x, y - before.y) > 3) return;
    await sleep(50);
  }
  assert.fail(`${what} does nothing`);
}

/** Waits until the hand is held, or released. */
const holds = (isHeld) =>
  tab.waitForFunction((held) => (window.hand !== null) === held, { timeout: 30_000 }, isHeld);

test("keys turn and zoom the view", async () => {
  await tab.focus("#view");
  for (const key of ["j", "l", "i", "k", "+", "-"]) {
    await assertMoved(() => tab.keyboard.press(key), key);
  }
});

test("the page names each key", async () => {
  const words = await textOf(tab, "#keys");
  for (const key of ["Arrows", "Page Up", "Shift", "Esc, Tab", "J L, I K", "+ −", "1 to 4"]) {
    assert.ok(words.includes(key), key);
  }
});

test("keys move the hand, and it is released when Tab leaves the view", async () => {
  await tab.focus("#view");
  for (const key of ["ArrowLeft", "PageUp"]) {
    await assertMoved(() => tab.keyboard.down(key), key);
    await tab.keyboard.up(key);
    await holds(true);
  }
  await tab.keyboard.press("Tab");
  assert.ok(!(await tab.$eval("#view", (view) => document.activeElement === view)));
  await holds(false);
});

test("a change of the status is announced once, and others at most every second", async () => {
  await tab.evaluate(() => {
    window.spoken = [];
    const spoken = document.querySelector("#spoken");
    new MutationObserver(() => {
      window.spoken.push([performance.now(), spoken.textContent]);
    }).observe(spoken, { childList: true, characterData: true, subtree: true });
  });
  await tab.focus("#view");
  // In and out of contact, faster than anyone can listen.
  for (let i = 0; i < 6; ++i) {
    await tab.keyboard.down(i % 2 ? "ArrowRight" : "ArrowLeft");
    await sleep(500);
    await tab.keyboard.up(i % 2 ? "ArrowRight" : "ArrowLeft");
  }
  await tab.keyboard.press("Escape");
  await sleep(2500);
  const told = await tab.evaluate(() => window.spoken);
  for (const [i, [at, words]] of told.slice(1).entries()) {
    assert.ok(at - told[i][0] > 1000, `"${words}" follows after ${at - told[i][0]} ms`);
    assert.notEqual(words, told[i][1]);
  }
  const live = await tab.$$eval('[aria-live], [role="status"], [role="alert"], output', (all) =>
    all.filter((one) => !one.closest('[aria-hidden="true"]')).map(({ id }) => id),
  );
  assert.deepEqual(live.sort(), ["lesson", "loading", "sides-words", "spoken", "toast"]);
});

/** Moves two fingers from and to these places. Returns them. */
async function pinched(from, to, isLifted = true) {
  const fingers = [];
  for (const [x, y] of from) fingers.push(await tab.touchscreen.touchStart(x, y));
  for (let step = 1; step <= 8; ++step) {
    for (const [i, finger] of fingers.entries()) {
      const [x, y] = [0, 1].map((k) => from[i][k] + ((to[i][k] - from[i][k]) * step) / 8);
      await finger.move(x, y);
    }
  }
  if (isLifted) for (const finger of fingers) await finger.end();
  return fingers;
}

const pageZoom = () => tab.evaluate(() => [window.visualViewport.scale, window.scrollY]);

test("a second finger zooms the view and leaves the hand held, under the first finger", async () => {
  await tab.$eval("#again", (button) => button.click());
  await tab.evaluate(() => window.scrollTo(0, 0));
  await sleep(700);
  const before = await pageZoom();
  const { x, y } = await handAt();
  const [first] = await pinched([[x, y]], [[x - 60, y]], false);
  const held = await handAt();
  const stage = { x: 0, y: 0, width: 390, height: 470 };
  const far = await bonePixels(tab, stage);
  const second = await tab.touchscreen.touchStart(held.x - 60, held.y + 60);
  for (let i = 1; i <= 8; ++i) await second.move(held.x - 60 - 8 * i, held.y + 60 + 8 * i);
  await sleep(500);
  const after = await handAt();
  assert.ok(Math.hypot(after.x - held.x, after.y - held.y) < 8, "the hand left the finger");
  const near = await bonePixels(tab, stage);
  assert.ok(near > 1.1 * far, `${far} pixels of bone before, ${near} after`);
  await second.end();
  await first.move(x - 120, y);
  await sleep(700);
  const moved = await handAt();
  assert.ok(Math.abs(moved.x - held.x + 60) < 12, "the hand was dropped");
  await holds(true);
  await first.end();
  await holds(false);
  assert.deepEqual(await pageZoom(), before);
});

test("two fingers beside the hand zoom and turn the view, not the page", async () => {
  const before = await pageZoom();
  const { x, y } = await handAt();
  const low = y < 300 ? y + 110 : y - 110;
  await assertMoved(
    () =>
      pinched(
        [
          [x - 40, low],
          [x + 10, low],
        ],
        [
          [x - 90, low],
          [x + 10, low],
        ],
      ),
    "a spread",
  );
  const next = await handAt();
  const beside = next.y < 240 ? next.y + 120 : next.y - 120;
  await assertMoved(
    () =>
      pinched(
        [
          [100, beside],
          [200, beside],
        ],
        [
          [100, beside],
          [190, beside + 50],
        ],
      ),
    "a twist",
  );
  assert.deepEqual(await pageZoom(), before);
  await holds(false);
});

test("what a finger touches is at least 44 px high", async () => {
  await tab.$$eval("details", (all) => {
    for (const one of all) one.open = true;
  });
  const low = await tab.$$eval("button, select, summary, #rules label, input[type=range]", (all) =>
    all
      .map((one) => [one.id || one.textContent.trim(), one.getBoundingClientRect().height])
      .filter(([, height]) => height > 0 && height < 44),
  );
  assert.deepEqual(low, []);
});

test("nothing was complained of", () => assert.deepEqual(tab.faults, []));
