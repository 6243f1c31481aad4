// SPDX-License-Identifier: BSD-3-Clause
/**
 * Takes docs/pictures/live.jpg: the page of `keepout live` with the brain, whose license allows it, while
 * a mouse drags the hand into it.
 *
 *   apps/web/build tests && KEEPOUT_WEB=build/web node docs/pictures/live.mjs KEEPOUT [BROWSER]
 */
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const [keepout, browserPath = "/usr/bin/chromium"] = process.argv.slice(2);
const packages = createRequire(new URL("../../apps/web/package.json", import.meta.url));
const folder = mkdtempSync(join(tmpdir(), "keepout-picture-"));
const page = join(folder, "page.html");
execFileSync(keepout, ["live", "brain", "--no-open", "--out", page]);

const browser = await packages("puppeteer-core").launch({
  executablePath: browserPath,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const tab = await browser.newPage();
await tab.setViewport({ width: 1280, height: 760, deviceScaleFactor: 1.6 });
await tab.goto(pathToFileURL(page).href);
await tab.waitForFunction(() => !document.querySelector("#grip").hidden, { timeout: 120_000 });
const { x, y } = await tab.evaluate(() => {
  const box = document.querySelector("#grip").getBoundingClientRect();
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
});
await tab.mouse.move(x, y);
await tab.mouse.down();
for (let i = 0; i <= 120; ++i) {
  await tab.mouse.move(x - Math.min(1.1 * i, 84), y + 22 * Math.sin(i / 16));
  await new Promise((done) => setTimeout(done, 30));
}
await new Promise((done) => setTimeout(done, 1500));
const picture = fileURLToPath(new URL("live.jpg", import.meta.url));
await tab.screenshot({ path: picture, type: "jpeg", quality: 82 });
await browser.close();
rmSync(folder, { recursive: true });
