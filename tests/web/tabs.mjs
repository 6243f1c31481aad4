// SPDX-License-Identifier: BSD-3-Clause
/**
 * Functions for tests of the pages of keepout in a browser: Chromium, or Firefox with KEEPOUT_BROWSER=firefox.
 */
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdirSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
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

/** True if the tests use Firefox. */
export const isFirefox = process.env.KEEPOUT_BROWSER === "firefox";

/** Options of a test that needs what the protocol does not offer in Firefox. */
export const onlyChromium = (reason) => ({ skip: isFirefox ? `not in Firefox: ${reason}` : false });

/** Options of a test that a short run makes in Chromium only. */
export const firefoxLong = {
  skip: isFirefox && !isLong ? "in Firefox only with ./test --long" : false,
};

export function empty(folder) {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
}

/** Starts the browser. It saves downloads in the folder, if there is one. */
export const launched = (folder) =>
  isFirefox ? launchedFirefox(folder) : launchedChromium(folder);

const launchedChromium = (folder) =>
  puppeteer.launch({
    executablePath: "/usr/bin/chromium",
    ...(folder && { downloadBehavior: { policy: "allow", downloadPath: resolve(folder) } }),
    args: [
      "--no-sandbox",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--disable-gpu-compositing", // pages are drawn by software faster without it
    ],
  });

/** Firefox has WebGL only on a screen, and only its preferences set media features and downloads. */
async function launchedFirefox(folder) {
  const screen = spawn("Xvfb", "-displayfd 3 -screen 0 1920x1200x24 -nolisten tcp".split(" "), {
    stdio: ["ignore", "ignore", "ignore", "pipe"],
  });
  const [display] = await once(screen.stdio[3], "data");
  const browser = await puppeteer.launch({
    browser: "firefox",
    executablePath: "/usr/bin/firefox-esr",
    headless: false,
    env: { ...process.env, DISPLAY: `:${String(display).trim()}` },
    timeout: 120_000,
    extraPrefsFirefox: {
      "webgl.force-enabled": true,
      "ui.prefersReducedMotion": 1,
      ...(folder && { "browser.download.folderList": 2, "browser.download.dir": resolve(folder) }),
    },
  });
  browser.on("disconnected", () => screen.kill());
  return browser;
}

/** Chooses the light or dark colors of a page. In Firefox, media queries do not see the choice. */
export const setScheme = (tab, scheme) =>
  isFirefox
    ? tab.evaluate((name) => {
        document.documentElement.style.colorScheme = name;
      }, scheme)
    : tab.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);

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
  if (!isFirefox)
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
  await setScheme(tab, scheme);
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

/** Returns how many of the pixels in a part of the page have the color of bone. */
export async function bonePixels(tab, clip) {
  const picture = await tab.screenshot({ encoding: "base64", clip });
  return tab.evaluate(async (data) => {
    const image = await createImageBitmap(
      await (await fetch(`data:image/png;base64,${data}`)).blob(),
    );
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data: values } = context.getImageData(0, 0, image.width, image.height);
    let count = 0;
    for (let i = 0; i < values.length; i += 4) {
      if (values[i] - values[i + 2] > 20 && values[i] - values[i + 1] < 40) ++count;
    }
    return count;
  }, picture);
}
