// SPDX-License-Identifier: BSD-3-Clause
/** A page of `keepout live` in a real browser: what its tests share. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readdirSync, renameSync, statSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import {
  assertAccessible,
  assertAlone,
  empty,
  launched,
  note,
  opened,
  root,
  sleep,
} from "./tabs.mjs";

export const skull = join(process.env.KEEPOUT_CACHE || join(root, ".cache"), "fixtures/skull.stl");

/**
 * The page that `keepout live` makes of the skull with options, by the arguments of a test: KEEPOUT
 * JUDGE FOLDER [BROWSER]. Tests how large it is.
 */
export async function livePage(...options) {
  const [keepout, judge, folder, browserPath = "/usr/bin/chromium"] = process.argv.slice(2);
  empty(folder);
  const run = (program, ...args) =>
    execFileSync(program, args, { encoding: "utf8", cwd: folder, maxBuffer: 1 << 26 });
  const page = join(folder, "page.html");
  run(keepout, "live", skull, ...options, "--no-open", "--out", page);
  const browser = await launched(browserPath);
  after(() => browser.close());

  test("the page is small, and needs nothing beside it", () => {
    const wasm = statSync(join(root, "build/wasm/keepout.wasm")).size;
    note(`wasm ${(wasm / 1e3).toFixed(0)} kB`);
    assert.ok(wasm <= 600e3, "keepout.wasm is larger than 600 kB");
    assertAlone(page, 6e6);
  });

  /** Opens the page, until the tool can be dragged. Its downloads come to the folder. */
  const open = async (viewport) => {
    const tab = await opened(browser, page, viewport, async (one) => {
      const client = await one.createCDPSession();
      await client.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: folder });
    });
    await ready(tab);
    return tab;
  };
  return { keepout, judge, folder, run, open };
}

/** The last tests of a page: it looks well on both, and nothing was complained of. */
export function testLooks(folder, tabs) {
  for (const [name, scheme] of [
    ["phone", "dark"],
    ["light", "light"],
    ["dark", "dark"],
  ]) {
    test(`controls have names and contrast holds: ${name}`, async () => {
      const { desk, phone } = tabs();
      const tab = name === "phone" ? phone : desk;
      await tab.bringToFront();
      await tab.$eval("#save", (button) => button.click()); // a word is told, on a ground of one color
      await assertAccessible(tab, scheme);
      await tab.screenshot({ path: join(folder, `${name}.png`) });
    });
  }
  test("nothing was complained of", () => {
    const { desk, phone } = tabs();
    assert.deepEqual([...desk.faults, ...phone.faults], []);
  });
}

/** Waits until there is a tool, whose state is told. */
export const ready = (tab) =>
  tab.waitForFunction(
    () =>
      !document.querySelector("#grip").hidden &&
      document.querySelector("#loading").hidden &&
      document.querySelector("#clearance").textContent.endsWith("mm"),
    { timeout: 60_000 },
  );

/** Where the middle of the hand is on the screen. */
export const handAt = (tab) =>
  tab.evaluate(() => {
    const { x, y, width, height } = document.querySelector("#grip").getBoundingClientRect();
    return { x: x + width / 2, y: y + height / 2 };
  });

/** Takes the hand, and leads it for some seconds along a way of the share of the time; holds it. */
export async function dragged(tab, seconds, way) {
  const { x, y } = await handAt(tab);
  await tab.mouse.move(x, y);
  await tab.mouse.down();
  const begin = performance.now();
  for (let t = 0; t < 1; t = (performance.now() - begin) / (1000 * seconds)) {
    const [across, down] = way(t);
    await tab.mouse.move(x + across, y + down);
    await sleep(8);
  }
}

export const textOf = (tab, selector) => tab.$eval(selector, (element) => element.textContent);

export const limitedCycles = async (tab) =>
  Number((await textOf(tab, "#limited")).split(" of ")[0].replaceAll(",", ""));

/** Notes how the control loop keeps its time. */
export async function noteRates(tab) {
  const [limited, lost, step, rate, frames] = await Promise.all(
    ["#limited", "#lost", "#step-time", "#rate", "#frames"].map((figure) => textOf(tab, figure)),
  );
  note(
    `limited: ${limited}; lost: ${lost}; a step takes ${step}; ${rate} cycles and ${frames} frames a second`,
  );
}

/** Waits for the end of a replay, and asserts that the tool went the same way. */
export async function assertReplayed(tab) {
  await tab.waitForFunction(
    () => document.querySelector("#toast").textContent.startsWith("Replayed"),
    { timeout: 60_000 },
  );
  assert.match(await textOf(tab, "#toast"), /bit for bit/);
}

/** Presses a button of the page and gives the file that it saves. */
export async function savedPath(tab, folder) {
  const before = new Set(readdirSync(folder));
  await tab.$eval("#save", (button) => button.click()); // on a phone it may be out of sight
  for (let i = 0; i < 200; ++i) {
    await sleep(50);
    const file = readdirSync(folder).find((name) => !before.has(name) && name.endsWith(".txt"));
    if (file !== undefined) {
      const kept = `path-${before.size}.txt`; // the next one has the same name
      renameSync(join(folder, file), join(folder, kept));
      return kept;
    }
  }
  assert.fail("no path was saved");
}
