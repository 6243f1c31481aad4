// SPDX-License-Identifier: BSD-3-Clause
/** Functions for tests of the pages of keepout in a browser. */
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

export const root = fileURLToPath(new URL("../..", import.meta.url));
export const packages = createRequire(join(root, "apps/web/package.json"));
const puppeteer = packages("puppeteer-core");

export const large = { width: 1280, height: 800 };
export const small = { width: 390, height: 844, hasTouch: true, isMobile: true };

export const note = (text) => console.log(`# ${text}`);
export const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

export const textOf = (tab, selector) => tab.$eval(selector, (element) => element.textContent);

/** True if `./test --long` runs the tests. */
export const isLong = Boolean(process.env.KEEPOUT_ALL_TRIALS);

/** Options of a test that only `./test --long` runs. */
export const onlyLong = { skip: isLong ? false : "only with ./test --long" };

export function empty(folder) {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
}

export const launched = (browserPath = "/usr/bin/chromium") =>
  puppeteer.launch({
    executablePath: browserPath,
    args: [
      "--no-sandbox",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--disable-gpu-compositing", // pages are drawn by software faster without it
    ],
  });

/**
 * Opens a page after `prepare` has set up its tab. Returns the tab, with a list of faults. The page moves nothing
 * by itself, unless `prepare` allows it.
 */
export async function opened(browser, file, viewport, prepare = () => {}) {
  const tab = await browser.newPage();
  tab.faults = [];
  tab.on("pageerror", (error) => tab.faults.push(String(error)));
  tab.on("console", (line) => {
    if (line.type() === "error") tab.faults.push(line.text());
  });
  tab.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) tab.faults.push(`asks for ${request.url()}`);
  });
  await tab.emulateMediaFeatures([{ name: "prefers-reduced-motion", value: "reduce" }]);
  await tab.setViewport(viewport);
  await prepare(tab);
  await tab.goto(pathToFileURL(file).href);
  return tab;
}

/** Asserts that a page has at most `most` bytes and names no other file. */
export function assertAlone(file, most) {
  const text = readFileSync(file, "utf8");
  note(`${(text.length / 1e3).toFixed(0)} kB`);
  assert.ok(Buffer.byteLength(text) <= most, `the page is larger than ${most} bytes`);
  assert.doesNotMatch(text, /(src|href)="(?!data:)[^"]*"/, "it names another file");
}

/** Asserts that controls have names and texts have contrast, in this color scheme. */
export async function assertAccessible(tab, scheme) {
  await tab.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
  await tab.addScriptTag({ path: packages.resolve("axe-core") });
  const { violations, passes } = await tab.evaluate(() =>
    window.axe.run({ resultTypes: ["violations"] }),
  );
  assert.ok(
    passes.some(({ id }) => id === "color-contrast"),
    "contrast was not checked",
  );
  assert.deepEqual(
    violations.map(({ id, nodes }) => [id, ...nodes.map(({ html }) => html)]),
    [],
    scheme,
  );
}
