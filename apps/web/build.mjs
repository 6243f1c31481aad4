// SPDX-License-Identifier: BSD-3-Clause
/**
 * Bundles the page of `keepout live` into one file, all but the anatomy, for which it has a comment;
 * apps/web/build calls it. From the environment: KEEPOUT_WASM, the folder with keepout.mjs and
 * keepout.wasm, of the CMake preset wasm; KEEPOUT_PAGE, the file to write.
 */
import { readFile, writeFile } from "node:fs/promises";
import { resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";

const { KEEPOUT_WASM: wasm, KEEPOUT_PAGE: page } = process.env;
if (!wasm || !page) {
  console.error("call apps/web/build, which says where keepout is and what to write");
  process.exit(2);
}
const source = fileURLToPath(new URL("src/live/", import.meta.url));

/** What esbuild makes of an entry: the text of the bundle. */
async function bundle(entry) {
  const { outputFiles } = await build({
    entryPoints: [source + entry],
    bundle: true,
    minify: true,
    write: false,
    target: "es2022",
    format: "iife",
    legalComments: "inline",
    alias: { "keepout-module": resolve(wasm, "keepout.mjs") },
    define: { "import.meta.url": '""' },
    external: ["module", "fs", "path", "url"],
    logOverride: { "empty-import-meta": "silent" },
  });
  return outputFiles[0].text;
}

/** A script element; nothing in it ends it. */
function script(type, id, text) {
  const name = id === "" ? "" : ` id="${id}"`;
  return `<script type="${type}"${name}>${text.replaceAll(/<\/(script)/gi, "<\\/$1")}</script>`;
}

/** Whose work the page holds, and under which terms. */
const licences = [
  "keepout, compiled with Eigen (MPL-2.0), Highway (Apache-2.0), xxHash (BSD-2-Clause) and the libraries",
  "of emscripten (MIT; libc++: Apache-2.0 with LLVM exceptions):",
  await readFile(new URL("../../LICENSE", import.meta.url), "utf8"),
  "three:",
  await readFile(new URL("node_modules/three/LICENSE", import.meta.url), "utf8"),
  "uPlot:",
  await readFile(new URL("node_modules/uplot/LICENSE", import.meta.url), "utf8"),
].join("\n");

const engine = gzipSync(await readFile(resolve(wasm, "keepout.wasm")), { level: 9 });
const scripts = [
  script("text/plain", "licences", licences),
  script("application/octet-stream", "engine", engine.toString("base64")),
  script("text/plain", "worker", await bundle("worker.ts")),
  script("text/javascript", "", await bundle("main.ts")),
].join("\n");
const style = await bundle("page.css");
const html = (await readFile(`${source}page.html`, "utf8"))
  .replace("/* keepout: style */", () => style)
  .replace("<!-- keepout: scripts -->", () => scripts);
await writeFile(page, html);
