// SPDX-License-Identifier: BSD-3-Clause
/**
 * Makes docs/pictures/live.gif: the page of `keepout live` with the brain, whose license allows it, while a
 * mouse drags the operator's handle into it. Needs Pillow (python3-pil).
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
await tab.setViewport({ width: 1280, height: 760, deviceScaleFactor: 1 });
await tab.goto(pathToFileURL(page).href);
await tab.waitForFunction(() => !document.querySelector("#grip").hidden, { timeout: 120_000 });
const { x, y } = await tab.evaluate(() => {
  const box = document.querySelector("#grip").getBoundingClientRect();
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
});
await tab.mouse.move(x, y);
await tab.mouse.down();
const frames = 56;
for (let i = 0; i < frames; ++i) {
  const turn = (2 * Math.PI * i) / frames;
  await tab.mouse.move(x - 42 * (1 - Math.cos(turn)), y + 26 * Math.sin(2 * turn), { steps: 3 });
  await new Promise((done) => setTimeout(done, 150));
  const path = join(folder, `${String(i).padStart(3, "0")}.png`);
  await tab.screenshot({ path, clip: { x: 312, y: 0, width: 656, height: 760 } });
}
await browser.close();
const gif = `
import glob, sys
from PIL import Image
frames = [Image.open(name).convert("RGB").resize((410, 475), Image.LANCZOS) for name in sorted(glob.glob(sys.argv[1]))]
colors = frames[len(frames) // 2].quantize(96)
frames = [frame.quantize(palette=colors, dither=Image.Dither.NONE) for frame in frames]
frames[0].save(sys.argv[2], save_all=True, append_images=frames[1:], duration=100, loop=0, optimize=True)
`;
const picture = fileURLToPath(new URL("live.gif", import.meta.url));
execFileSync("/usr/bin/python3", ["-c", gif, join(folder, "*.png"), picture]);
rmSync(folder, { recursive: true });
