// SPDX-License-Identifier: BSD-3-Clause
/** The documentation site, opened from the disk: links, requests, search and width: site_test.mjs SITE */
import assert from "node:assert/strict";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { dirname, join, relative, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { large, launched, opened, small } from "../web/tabs.mjs";

const site = resolve(process.argv.at(-1));
const pages = readdirSync(site, { recursive: true }).filter((name) => name.endsWith(".html"));
const text = new Map(pages.map((name) => [join(site, name), readFileSync(join(site, name), "utf8")]));
// Not those that lead to another page at once.
const ofDocs = pages.filter((name) => !name.startsWith("api") && !text.get(join(site, name)).includes('"refresh"'));
let browser;
before(async () => (browser = await launched()));
after(() => browser.close());

test("each link within the site leads somewhere", () => {
  const ids = new Map([...text].map(([file, html]) => [file, new Set(html.match(/(?<=\s(?:id|name)=")[^"]+/g))]));
  const faults = [];
  for (const [file, html] of text) {
    for (const [, link] of html.matchAll(/\s(?:href|src|content="0; url)="?([^"]+)"/g)) {
      if (/^[a-z]+:|^#nested-classes$/.test(link)) continue; // the latter is Doxygen's
      const [path, anchor] = link.replaceAll("&amp;", "&").split("#").map(decodeURIComponent);
      const target = path ? join(dirname(file), path.split("?")[0]) : file;
      const found = existsSync(target) && (!anchor || !ids.has(target) || ids.get(target).has(anchor));
      if (!found) faults.push(`${relative(site, file)}: ${link}`);
    }
  }
  assert.deepEqual(faults, []);
  assert.ok(ofDocs.length > 35 && pages.length > 200, `${pages.length} pages`);
});

test("each page fits a phone, renders its formulas, and asks for nothing but files of the site", async () => {
  const faults = [];
  const tab = await opened(browser, join(site, "docs/README.html"), small);
  for (const name of [...ofDocs, "api/index.html", "api/classkeepout_1_1MotionConstraint.html"]) {
    await tab.goto(pathToFileURL(join(site, name)).href);
    faults.push(...tab.faults.splice(0).map((fault) => `${name}: ${fault}`));
    const [width, raw] = await tab.evaluate(() => [
      document.documentElement.scrollWidth,
      [...document.querySelectorAll(".math")].filter((formula) => !formula.querySelector(".katex-html")).length,
    ]);
    if (width > small.width) faults.push(`${name}: ${width} pixels wide`);
    if (raw) faults.push(`${name}: ${raw} formulas are not rendered`);
  }
  assert.deepEqual(faults, []);
});

for (const [words, page] of Object.entries({
  "remote center of motion": "guides",
  "virtual fixture": "concepts",
  trocar: "guides",
  meters: "meshes",
  slow: "performance",
})) {
  test(`the search for "${words}" finds ${page}`, async () => {
    const tab = await opened(browser, join(site, "docs/README.html"), large);
    await tab.type('input[name="q"]', words);
    await Promise.all([tab.waitForNavigation(), tab.keyboard.press("Enter")]);
    await tab.waitForFunction(() => /finished/.test(document.querySelector(".search-summary")?.textContent));
    const found = await tab.$$eval("ul.search a", (links) => links.map((link) => link.getAttribute("href")));
    assert.ok(found.some((link) => link.startsWith(`docs/${page}.html`)), `found: ${found}`);
    assert.deepEqual(tab.faults, []);
  });
}
