// SPDX-License-Identifier: BSD-3-Clause
/** A page of `keepout live` in a real browser: what its tests share. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readdirSync, renameSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

export const root = fileURLToPath(new URL("../..", import.meta.url));
export const packages = createRequire(join(root, "apps/web/package.json"));
const puppeteer = packages("puppeteer-core");
export const skull = join(process.env.KEEPOUT_CACHE || join(root, ".cache"), "fixtures/skull.stl");

export const large = { width: 1280, height: 800 };
export const small = { width: 390, height: 844, hasTouch: true, isMobile: true };

export const note = (text) => console.log(`# ${text}`);
export const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

/** An empty folder; gives what runs a program there, and what that prints. */
export function programsIn(folder) {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  return (program, ...args) =>
    execFileSync(program, args, { encoding: "utf8", cwd: folder, maxBuffer: 1 << 26 });
}

export const launched = (browserPath) =>
  puppeteer.launch({
    executablePath: browserPath,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });

/** Opens the page; gives it back once the tool can be dragged. Its downloads come to the folder. */
export async function opened(browser, page, folder, viewport) {
  const tab = await browser.newPage();
  tab.faults = [];
  tab.on("pageerror", (error) => tab.faults.push(String(error)));
  tab.on("console", (line) => {
    if (line.type() === "error") tab.faults.push(line.text());
  });
  await tab.setViewport(viewport);
  const client = await tab.createCDPSession();
  await client.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: folder });
  await tab.goto(pathToFileURL(page).href);
  await ready(tab);
  return tab;
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

export const textOf = (tab, selector) => tab.$eval(selector, (element) => element.textContent);

export const limitedCycles = async (tab) =>
  Number((await textOf(tab, "#limited")).split(" of ")[0].replaceAll(",", ""));

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

/** Controls have names, and what is written stands out, in this scheme of colours; keeps a picture. */
export async function looksWell(tab, scheme, picture) {
  await tab.bringToFront();
  await tab.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
  await tab.$eval("#save", (button) => button.click()); // a word is told, on a ground of one colour
  await tab.addScriptTag({ path: packages.resolve("axe-core") });
  const { violations, passes } = await tab.evaluate(() => window.axe.run());
  assert.ok(
    passes.some(({ id }) => id === "color-contrast"),
    "contrast was not looked at",
  );
  assert.deepEqual(
    violations.map(({ id, nodes }) => [id, ...nodes.map((node) => node.html)]),
    [],
  );
  await tab.screenshot({ path: picture });
}
