// SPDX-License-Identifier: BSD-3-Clause
/**
 * Bundles each page of keepout into one file. Only the data of the command is missing: the anatomy
 * of `keepout live`, and the records of reports. apps/web/build calls this script. Environment:
 *   KEEPOUT_PAGES  the directory to write to
 *   KEEPOUT_WASM   the directory with keepout.mjs and keepout.wasm, of the CMake preset wasm; if
 *   unset, only the reports are made, which contain no engine
 */
import { readFile, writeFile } from "node:fs/promises";
import { join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";

const { KEEPOUT_WASM: wasm, KEEPOUT_PAGES: pages } = process.env;
if (!pages) {
  console.error("call apps/web/build, which says where to write the pages");
  process.exit(2);
}
const here = fileURLToPath(new URL(".", import.meta.url));

/**
 * Replaces packages of the plots by empty functions of the same names: no plot is a map, and all
 * colors are those of the page's style.
 */
const withoutMaps = {
  name: "without maps",
  setup(bundler) {
    bundler.onLoad(
      { filter: /d3-(geo|scale-chromatic)[\\/]dist[\\/].*\.mjs$/ },
      async ({ path }) => {
        const names = Object.keys(await import(pathToFileURL(path)));
        return {
          contents: names.map((name) => `export const ${name} = () => undefined;`).join("\n"),
        };
      },
    );
  },
};

/** Parts of three.js's shaders for materials, lights and surfaces that no page has. */
const unusedShaders =
  /^(alphahash|backgroundCube|batching|bumpmap|clearcoat|cube|displacementmap|distance|emissivemap|envmap|equirect|gradientmap|iridescence|lightmap|lightprobes|lights_(physical|toon)|mesh(matcap|normal|physical|toon)|metalnessmap|morph|normalmap|points|roughnessmap|shadow|skin|specularmap|sprite|tonemapping|transmission)/;

/** Removes shaders that no page uses from three.js, and blanks from the others. */
const smallShaders = {
  name: "small shaders",
  setup(bundler) {
    bundler.onLoad({ filter: /three[\\/]build[\\/]three\.module\.js$/ }, async ({ path }) => {
      const text = await readFile(path, "utf8");
      const names = new Map(
        [...text.matchAll(/^\t(\w+): ([\w$]+),?$/gm)].map(([, name, variable]) => [variable, name]),
      );
      const contents = text.replaceAll(
        /^((?:var|const) ([\w$]+) = )("(?:[^"\\]|\\.)*");$/gm,
        (line, start, variable, shader) => {
          const name = names.get(variable);
          if (name === undefined) return line;
          if (unusedShaders.test(name)) return `${start}"";`;
          const short = shader
            .replaceAll(/(\\n)(\\[nt])+/g, "$1")
            .replaceAll("( ", "(")
            .replaceAll(" )", ")")
            .replaceAll(", ", ",")
            .replaceAll(/ ([*<>=]=?) /g, "$1");
          return `${start}${short};`;
        },
      );
      return { contents };
    });
  },
};

/** Returns the text of esbuild's bundle of an entry, and the packages in it. */
async function bundle(entry, modules = {}) {
  const { outputFiles, metafile } = await build({
    entryPoints: [join(here, "src", entry)],
    absWorkingDir: here,
    bundle: true,
    minify: true,
    write: false,
    metafile: true,
    target: "es2022",
    format: "iife",
    legalComments: "inline",
    alias: modules,
    plugins: [withoutMaps, smallShaders],
    define: { "import.meta.url": '""' },
    external: ["module", "fs", "path", "url"],
    logOverride: { "empty-import-meta": "silent" },
  });
  const [output] = Object.values(metafile.outputs);
  const packages = Object.entries(output.inputs)
    .filter(([, { bytesInOutput }]) => bytesInOutput > 0)
    .map(([file]) => file.match(/^.*node_modules\/(@[^/]+\/)?[^/]+/)?.[0])
    .filter((folder) => folder !== undefined);
  // The lines of a minified text are those of shaders.
  return { text: outputFiles[0].text.replaceAll(/\n[ \t]+/g, "\n"), packages };
}

/** Returns a script element. No text in it can end the element. */
function script(type, id, text) {
  const name = id === "" ? "" : ` id="${id}"`;
  return `<script type="${type}"${name}>${text.replaceAll(/<\/(script)/gi, "<\\/$1")}</script>`;
}

/**
 * Returns the licenses of the code in the page. Each appears once, after the packages that it
 * covers.
 */
async function licences(own, packages) {
  const holders = new Map();
  for (const folder of [...new Set(packages)].sort()) {
    const { name, license } = JSON.parse(
      await readFile(join(here, folder, "package.json"), "utf8"),
    );
    const terms = await readFile(join(here, folder, "LICENSE"), "utf8").catch((missing) => {
      if (license === "Unlicense") return "in the public domain (Unlicense)\n";
      throw missing;
    });
    holders.set(terms, [...(holders.get(terms) ?? []), name]);
  }
  const theirs = [...holders].map(([terms, names]) => `${names.join(", ")}:\n${terms}`);
  return [own, await readFile(join(here, "../../LICENSE"), "utf8"), ...theirs].join("\n");
}

/** Writes a page: HTML and style of its folder, licenses, and the scripts of these bundles. */
async function writePage(name, folder, own, scripts, bundles) {
  const style = await bundle(`${folder}/page.css`);
  const packages = [style, ...bundles].flatMap((one) => one.packages);
  const all = [script("text/plain", "licences", await licences(own, packages)), ...scripts];
  const html = (await readFile(join(here, "src", folder, "page.html"), "utf8"))
    .replace("/* keepout: style */", () => style.text)
    .replace("<!-- keepout: scripts -->", () => all.join("\n"));
  await writeFile(join(pages, name), html);
}

for (const [name, entry] of [
  ["report.html", "report/main.ts"],
  ["report_with_anatomy.html", "report/main_with_anatomy.ts"],
]) {
  const main = await bundle(entry);
  await writePage(name, "report", "keepout:", [script("text/javascript", "", main.text)], [main]);
}
if (wasm) {
  const modules = { "keepout-module": resolve(wasm, "keepout.mjs") };
  const binary = gzipSync(await readFile(resolve(wasm, "keepout.wasm")), { level: 9 });
  const [worker, main] = [await bundle("live/worker.ts", modules), await bundle("live/main.ts")];
  const own = [
    "keepout, compiled with Eigen (MPL-2.0), Highway (Apache-2.0), xxHash (BSD-2-Clause) and the libraries",
    "of emscripten (MIT; libc++: Apache-2.0 with LLVM exceptions):",
  ].join("\n");
  const scripts = [
    script("application/octet-stream", "engine", binary.toString("base64")),
    script("text/plain", "worker", worker.text),
    script("text/javascript", "", main.text),
  ];
  await writePage("live.html", "live", own, scripts, [worker, main]);
}
