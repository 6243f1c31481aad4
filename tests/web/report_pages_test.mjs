// SPDX-License-Identifier: BSD-3-Clause
/**
 * Tests the reports of the commands in a browser with real input:
 *
 *   report_pages_test.mjs KEEPOUT FOLDER
 *
 * Each command runs on a small mesh, and the test opens its page. Every number on the page must be one of
 * the record. Tables sort, plots show what is under the pointer, and the anatomy turns. If REPORT_RECORDS
 * names a folder, the test reads the records in it instead.
 */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { after, test } from "node:test";
import { gunzipSync } from "node:zlib";
import { experimentsRecord } from "./experiments_record.mjs";
import {
  assertAccessible,
  assertAlone,
  empty,
  isFirefox,
  isLong,
  launched,
  note,
  onlyChromium,
  onlyLong,
  opened as openedTab,
  sleep,
  small,
} from "./tabs.mjs";

const [keepout, folder] = process.argv.slice(2);
const given = process.env.REPORT_RECORDS;
const large = { width: 1280, height: 900 };
empty(folder);

/** Makes a page by a command. The command may find that a check fails (exit status 1). */
function run(name, ...args) {
  const file = join(folder, `${name}.html`);
  try {
    execFileSync(keepout, [...args, "--out", file], {
      cwd: folder,
      maxBuffer: 1 << 26,
      stdio: "pipe",
    });
  } catch (failure) {
    if (failure.status !== 1) throw failure;
  }
  return file;
}

const experimentsFile = join(folder, "experiments.json");
writeFileSync(experimentsFile, JSON.stringify(experimentsRecord));

/**
 * A box with a missing triangle, a flipped triangle, and a part of a triangle's edge. Because of one corner,
 * the middle of an edge has a coordinate near 1e-15 mm.
 */
const faultyFile = join(folder, "faulty.obj");
writeFileSync(
  faultyFile,
  `v -20.000000000000004 -20 -20\nv 20 -20 -20\nv 20 20 -20\nv -20 20 -20
v -20 -20 20\nv 20 -20 20\nv 20 20 20\nv -20 20 20
f 1 3 2\nf 1 4 3\nf 5 7 8\nf 1 6 2\nf 1 6 5\nf 2 3 7
f 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\nf 4 4 1\n`,
);

const files = given
  ? readdirSync(given)
      .filter((name) => name.endsWith(".json"))
      .map((name) => run(basename(name, ".json"), "report", join(given, name)))
  : [
      run(
        "simulate",
        ..."simulate cube --strokes 2 --cycles 300".split(" "),
        ...(isLong ? ["--bench"] : []),
      ),
      run(
        "open",
        ..."simulate flat_plate --strokes 2 --cycles 300 --guide ball:50,50,0:30".split(" "),
      ),
      ...(isLong
        ? [run("tool", ..."simulate cube --strokes 2 --cycles 300 --tool blade:20:6:1".split(" "))]
        : []),
      run(
        "bench",
        ..."bench --mesh cube,sphere --seconds 0.01 --radius".split(" "),
        isLong ? "5,1" : "5",
      ),
      run(
        "speed",
        ..."bench --speed --quick --triangles 4000 --steps 3000 --largest 80000".split(" "),
      ),
      run("compare", "compare", "cube", "--poses", "6", "--problems", "100", "--pairs", "20"),
      run("plan", "plan", "cube", "--problems", "2", "--resolution", "0.01"),
      run(
        "plan_robot",
        ..."plan cube --robot psm --problems 1 --seeds 2 --resolution 0.01".split(" "),
      ),
      run("verify", "verify", "cube", "sphere", "--steps", "2000"),
      run(
        "simulate_robot",
        ..."simulate gear --robot psm --strokes 3 --cycles 200 --speed 5".split(" "),
        ..."--guide axis:6:0,1,0:0,0,1:2.5".split(" "),
      ),
      run("experiments", "report", experimentsFile),
      run("inspect", "inspect", faultyFile, "--self-intersections"),
      run("verify_robot", ..."verify cube gear --robot psm --cycles 300".split(" ")),
    ];

/** Returns the record in a page. */
function recordOf(file) {
  const [, packed] = readFileSync(file, "utf8").match(/id="record">([^<]*)</);
  return JSON.parse(gunzipSync(Buffer.from(packed, "base64")).toString("utf8"));
}
const pages = files.map((file) => ({
  file,
  name: basename(file, ".html"),
  record: recordOf(file),
}));
const showsAnatomy = ({ record }) =>
  ["simulate", "simulate_robot", "plan", "inspect"].includes(record.keepout_record);

const keysOf = (pointer) =>
  pointer
    .split("/")
    .slice(1)
    .map((key) => key.replaceAll("~1", "/").replaceAll("~0", "~"));
const valueAt = (record, pointer) => keysOf(pointer).reduce((value, key) => value?.[key], record);

const microseconds = { ms: 1e-3, µs: 1, ns: 1e3 };
const millimetres = { mm: 1, µm: 1e3, nm: 1e6 };

/** Returns the factor that converts a number of the record to the displayed unit. */
function scaleOf(keys, unit) {
  const kind = keys
    .map((key) => {
      if (key === "bins") return "ns";
      return key.replace(/seconds$/, "s").match(/(?:^|_)(us|ns|s|mm|share)$/)?.[1];
    })
    .findLast((one) => one !== undefined);
  if (kind === "us") return microseconds[unit] ?? 1;
  if (kind === "ns") return unit === "" || unit === "ns" ? 1 : microseconds[unit] / 1e3;
  if (kind === "share") return 100;
  if (unit === "%") return 100;
  if (kind === "s") return 1e6 * (microseconds[unit] ?? 1e-6);
  return millimetres[unit] ?? 1;
}

const raised = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** The names of rules and modes on the live page, and those that only reports have. */
const livePage = readFileSync(
  join(import.meta.dirname, "../../apps/web/src/live/page.html"),
  "utf8",
);
const ruleNames = new Map([
  ...[...livePage.matchAll(/name="rule" value="(\w+)" \/><span>([^<]+)</g)].map((found) =>
    found.slice(1),
  ),
  ["no_fixture", "No fixture"],
  ["linearized", "Linearized"],
]);
assert.equal(ruleNames.size, 7);
const ruleName = (name) => ruleNames.get(name.replace(" ", "_")) ?? name;

/** Returns a headline with the names of rules as pages show them. */
const headlineOf = ({ headline }) =>
  headline.replaceAll(/'(\w+)'/g, (quoted, name) => ruleNames.get(name) ?? quoted);

/** Returns what the browser reported. One figure of the experiments is no SVG on purpose, which only Firefox reports. */
const faultsOf = ({ faults }, { keepout_record }) =>
  isFirefox && keepout_record === "experiments"
    ? faults.filter((fault) => !/^Error: XML Parsing Error: unclosed token/.test(fault))
    : faults;

/** Returns true if a text shows the value, name or number that the record has at a pointer. */
function isOf(record, { text, from, role, unit: apart = "" }) {
  const keys = keysOf(from);
  if (role === "name") return text === keys.at(-1);
  if (role === "ordinal") return text.replaceAll(",", "") === String(Number(keys.at(-1)) + 1);
  const value = valueAt(record, from);
  if (from.endsWith("/headline")) return text === headlineOf({ headline: value });
  const isRule = /\/(name|mode|activation)$/.test(from);
  if (typeof value !== "number") return text === (isRule ? ruleName(value) : String(value));
  if (text === String(value)) return true;
  const parts = text.match(/^([-−]?[\d,]*\.?\d+)(?:·10(⁻?)([⁰¹²³⁴⁵⁶⁷⁸⁹]+))?(?:\s*([^\d\s].*))?$/);
  if (!parts) return /^under\s/.test(text) && Math.abs(value) < 1e-6;
  const [, digits, minus, exponent = "", unit = apart] = parts;
  const power = Number(
    (minus ? "-" : "") + ([...exponent].map((d) => raised.indexOf(d)).join("") || 0),
  );
  const shown = Number(digits.replaceAll(",", "").replace("−", "-")) * 10 ** power;
  const decimals = digits.includes(".") ? digits.length - digits.indexOf(".") - 1 : 0;
  const depth = unit.endsWith(" deep");
  const exact = (depth ? -value : value) * scaleOf(keys, unit.replace(" deep", ""));
  const half = 0.5 * 10 ** (power - decimals);
  const isNear = Math.abs(shown - exact) <= half + 1e-9 * Math.abs(exact);
  const isCoordinate = keys.includes("at") || keys.includes("bounds");
  return isNear && (isCoordinate || (exact === 0) === (shown === 0));
}

/** Words with digits that the page itself contains. */
const ownWords = [
  "99.999 %",
  "99.9 %",
  "99 %",
  "1 %",
  "1 kHz",
  "0.000001 mm",
  "0.05 mm",
  "1 mm",
  "1 nm",
  "Li et al. 2020",
  "i7-8700",
];

/** Returns all texts with digits in elements, each with its stated place in the record. */
const textsWithDigits = (tab, selector) =>
  tab.$$eval(selector, (elements) =>
    elements.flatMap((element) => {
      const found = [];
      const walker = document.createTreeWalker(element, NodeFilter.SHOW_TEXT);
      for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const parent = node.parentElement;
        if (!/\d/.test(node.data) || parent.closest("script, style, noscript")) continue;
        if (parent.closest('[aria-label$="axis tick label"], .scale')) continue;
        const place = parent.closest("[data-from]");
        const role = ["name", "ordinal"].find((kind) => place?.hasAttribute(`data-${kind}`));
        found.push({ text: (place ?? node).textContent.trim(), role, ...place?.dataset });
      }
      return found;
    }),
  );

/** Asserts that every number in elements is from the record or from the page's own words. */
async function assertNumbers(tab, record, selector) {
  const texts = await textsWithDigits(tab, selector);
  const strange = texts.filter((one) => {
    if (one.from !== undefined) return !isOf(record, one);
    return /\d/.test(
      ownWords.reduce((text, words) => text.replaceAll(words, ""), one.text.replace(/\s/g, " ")),
    );
  });
  assert.deepEqual(
    strange.map((one) => ({ ...one, value: one.from && valueAt(record, one.from) })),
    [],
  );
  return texts.length;
}

const browser = await launched();

/** Opens a page. Returns it when it is complete. */
async function opened(file, viewport, prepare) {
  const tab = await openedTab(browser, file, viewport, prepare);
  await tab.waitForSelector("main > section:last-child .command", { timeout: 120_000 });
  await sleep(500); // for elements that are drawn when they first become visible
  return tab;
}

/** Sorts tables by their headings, by mouse and by key, and asserts that the columns are in order. */
async function assertSorts(tab, record) {
  for (const table of await tab.$$("table")) {
    const columns = (await table.$$("thead button")).length;
    for (const place of [0, Math.min(2, columns - 1)]) {
      for (const direction of ["ascending", "descending"]) {
        const button = (await table.$$("thead button"))[place];
        if (place === 0) {
          await button.focus();
          await tab.keyboard.press("Enter");
        } else {
          await button.evaluate((one) => one.scrollIntoView({ block: "center", inline: "center" }));
          await button.click();
        }
        const { sort, pointers } = await table.evaluate((element, column) => {
          const cells = [...element.tBodies[0].rows].map(({ cells }) => cells[column]);
          const from = (cell) =>
            cell.dataset.from ?? cell.querySelector("[data-from]")?.dataset.from;
          const head = element.tHead.rows[0].cells[column];
          return { sort: head.getAttribute("aria-sort"), pointers: cells.map(from) };
        }, place);
        assert.equal(sort, direction);
        const values = pointers.map((from) => (from ? valueAt(record, from) : null));
        const numbers = values.filter((value) => typeof value === "number");
        const sorted = [...numbers].sort((a, b) => (direction === "ascending" ? a - b : b - a));
        assert.deepEqual(numbers, sorted);
      }
    }
  }
}

/** Returns the screen positions of the marks of a plot, and of some points along a line. */
const marksOf = (plot) =>
  plot.evaluate((one) => {
    const kinds = ["dot", "bar", "line", "rect"].map(
      (kind) => `[aria-label="${kind}"] ${kind === "line" ? "path" : "> *"}`,
    );
    const kind = kinds.find((marks) => one.querySelector(marks)) ?? "none";
    const room = one.querySelector("svg").getBoundingClientRect();
    return [...one.querySelectorAll(kind)]
      .flatMap((mark) => {
        const box = mark.getBoundingClientRect();
        if (!kind.includes("line"))
          return [{ x: box.x + box.width / 2, y: box.y + box.height / 2 }];
        const length = mark.getTotalLength();
        return [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9].map((part) => {
          const { x, y } = mark
            .getPointAtLength(part * length)
            .matrixTransform(mark.getScreenCTM());
          return { x, y };
        });
      })
      .filter(({ x, y }) => x > room.left && x < room.right && y > room.top && y < room.bottom);
  });

/** Points at the marks of each visible plot until a tooltip appears. Returns the number of plots with one. */
async function assertTips(tab, record) {
  let told = 0;
  for (const plot of await tab.$$(".plot")) {
    if (!(await plot.isVisible())) continue;
    await plot.evaluate((one) => one.scrollIntoView({ block: "center" }));
    await sleep(50);
    const marks = await marksOf(plot);
    if (marks.length === 0) continue;
    let tip = null;
    for (const { x, y } of marks.slice(0, 20)) {
      await tab.mouse.move(x - 1, y);
      await tab.mouse.move(x, y);
      await sleep(30);
      tip ??= await plot.$(".tip:not([hidden])");
      if (tip) break;
    }
    assert.ok(tip, `nothing is told by: ${await plot.evaluate((one) => one.ariaLabel)}`);
    await tip.evaluate((one) => one.setAttribute("id", "told"));
    assert.ok((await assertNumbers(tab, record, "#told")) > 0, "a tooltip shows no number");
    await tip.evaluate((one) => one.removeAttribute("id"));
    told += 1;
  }
  return told;
}

/** Returns the largest difference between the red values of a picture. */
const contrastOf = (picture) =>
  picture.evaluate((canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const reds = new Set(data.filter((_, i) => i % 4 === 0));
    return Math.max(...reds) - Math.min(...reds);
  });

/** Scrolls to each picture and asserts that it is drawn. */
async function assertDrawn(tab) {
  const pictures = await tab.$$("canvas.anatomy");
  assert.ok(pictures.length > 0);
  for (const picture of pictures) {
    await picture.evaluate((one) => one.scrollIntoView({ block: "center" }));
    await until(async () => (await contrastOf(picture)) > 60, "a picture is not drawn");
  }
}

/** Waits until a condition is true, for at most ten seconds. */
async function until(holds, otherwise) {
  for (let i = 0; i < 100 && !(await holds()); ++i) await sleep(100);
  assert.ok(await holds(), otherwise);
}

/**
 * Asserts that a page begins with what was done, the headline, and what differs. Date and machine
 * come last. Durations have a suitable unit.
 */
async function assertOrder(tab, record) {
  const { begin, late, words } = await tab.$eval("main", (main) => {
    const places = [...main.querySelectorAll('[data-from="/date"], [data-from^="/machine/"]')];
    return {
      begin: [...main.children].slice(0, 2).map((one) => [one.localName, one.textContent]),
      // The time that reading the clock adds belongs to the method of a benchmark.
      late: places
        .filter(({ dataset }) => dataset.from !== "/machine/clock_ns")
        .every((one) => main.lastElementChild.contains(one)),
      words: main.innerText,
    };
  });
  assert.deepEqual(begin, [
    ["p", record.subject],
    ["h1", headlineOf(record)],
  ]);
  assert.ok(late, "a date or a machine is not at the end of the page");
  assert.doesNotMatch(words, /\b0\.0\d*\s(s|mm deep)\b/, "a value has an unsuitable unit");
  assert.equal(
    /was stopped/.test(words),
    !record.complete && record.keepout_record !== "experiments",
  );
}

/** Asserts that print has text, and wide sheets for the table of all rows. Firefox compresses what it prints. */
async function assertPrints(tab, record) {
  const paper = await tab.pdf({ preferCSSPageSize: true, format: "A4", printBackground: true });
  const text = Buffer.from(paper).toString("latin1");
  const sheets = text.match(/\/Type \/Page\b/g)?.length ?? 0;
  note(`${sheets} sheets, ${(paper.length / 1e3).toFixed(0)} kB`);
  assert.ok(sheets > 0 && text.includes("/Font"), "print has no text");
  const isWide = /\/MediaBox \[0 0 84[12]/.test(text);
  assert.equal(
    isWide,
    Boolean(record.benchmark?.rows.length),
    "the table of all rows is on wide sheets",
  );
}

for (const { file, name, record } of pages) {
  const hasAnatomy = showsAnatomy({ record });
  // Pages share their code for anatomy and for small screens, so a short test checks a few of them.
  const ifDrawn = name === "simulate" || given ? {} : onlyLong;
  const isOnPhone = given || ["simulate", "bench", "experiments"].includes(name);
  const onPhone = isOnPhone ? {} : onlyLong;
  const testAnatomy = hasAnatomy ? test : () => {};
  let desk; // shared by the next tests

  testAnatomy(`${name}: a drag turns all pictures of a group alike`, ifDrawn, async () => {
    const tab = await opened(file, large);
    desk = tab;
    await assertDrawn(tab);
    for (const group of await tab.$$("[data-view]")) {
      const before = await group.evaluate((one) => one.dataset.view);
      const picture = await group.$(".picture");
      await picture.evaluate((one) => one.scrollIntoView({ block: "center" }));
      const { x, y, width, height } = await picture.boundingBox();
      const pixels = () =>
        group.$$eval("canvas.anatomy", (all) => all.map((canvas) => canvas.toDataURL()));
      const still = await pixels();
      await tab.mouse.move(x + width / 2, y + height / 2);
      await tab.mouse.down();
      await tab.mouse.move(x + width / 2 + 80, y + height / 2 + 25, { steps: 5 });
      await tab.mouse.up();
      assert.notEqual(await group.evaluate((one) => one.dataset.view), before, "nothing turned");
      const allTurned = async () => (await pixels()).every((one, i) => one !== still[i]);
      await until(allTurned, "a picture has not turned with the others");
    }
    if (record.keepout_record.startsWith("simulate")) {
      const now = () =>
        tab.$$eval(".now, .cycle", (all) => all.map((one) => one.textContent).join());
      const before = await now();
      await tab.focus("input[type=range]");
      for (let i = 0; i < 20; ++i) await tab.keyboard.press("ArrowLeft");
      await sleep(500);
      assert.notEqual(await now(), before, "the time does not move");
      await assertNumbers(tab, record, "body");
    }
    // Selects another stroke of an instrument, and the worst moment of each of its modes.
    for (const list of await tab.$$('select[aria-label="moment"]')) {
      await tab.select('select[aria-label="stroke"]', "1");
      for (const [number, run] of record.meshes[0].strokes[1].runs.entries()) {
        await list.select(String(number));
        const slider = await tab.$eval("input[type=range]", (one) => one.value);
        assert.equal(slider, String(run.worst));
        await assertNumbers(tab, record, "body");
      }
    }
  });

  test(`${name}: every number is of the record, tables sort, plots tell`, async () => {
    assertAlone(file, hasAnatomy ? 8e6 : 500e3);
    const tab = desk ?? (await opened(file, large));
    const headline = await tab.$eval("h1", (one) => one.textContent);
    assert.equal(headline, headlineOf(record));
    assert.match(await tab.title(), new RegExp(`keepout ${record.keepout_record}$`));
    note(`${await assertNumbers(tab, record, "body")} texts with numbers`);
    await assertSorts(tab, record);
    const tips = await assertTips(tab, record);
    note(`${tips} plots told`);
    const plotted = ["simulate", "bench", "speed", "compare", "plan", "verify", "verify_robot"];
    if (record.keepout_record !== "plan_robot") {
      assert.equal(tips > 0, plotted.includes(record.keepout_record));
    }
    await assertOrder(tab, record);
    // After a change of legends and choices, numbers are still from the record.
    for (const list of await tab.$$(".selection select")) {
      const values = await list.$$eval("option", (all) => all.map(({ value }) => value));
      for (const value of [...values.slice(1), values[0]]) {
        await list.select(value);
        await assertNumbers(tab, record, "main > section:not(.everything)"); // all rows stay
      }
    }
    for (const field of await tab.$$(".legend input")) await field.evaluate((one) => one.click());
    await assertNumbers(tab, record, "body");

    if (isFirefox) note("not in Firefox: print");
    else await assertPrints(tab, record);
    await assertAccessible(tab, "light");
    if (isLong) await assertAccessible(tab, "dark"); // as on a phone, below
    assert.deepEqual(faultsOf(tab, record), []);
    await tab.close();
  });

  test(`${name}: on a phone`, onPhone, async () => {
    const tab = await opened(file, small);
    const widths = await tab.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    assert.equal(widths[0], widths[1], "the page scrolls sideways");
    await assertAccessible(tab, "dark");
    assert.deepEqual(faultsOf(tab, record), []);
    await tab.close();
  });

  testAnatomy(`${name}: without WebGL there are still pictures`, ifDrawn, async () => {
    const tab = await opened(file, large, (page) =>
      page.evaluateOnNewDocument(() => {
        const own = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
          return kind.startsWith("webgl") ? null : own.call(this, kind, ...rest);
        };
      }),
    );
    await assertDrawn(tab);
    assert.match(await tab.$eval("body", (body) => body.textContent), /WebGL/);
    assert.deepEqual(tab.faults, []);
    await tab.close();
  });
}

for (const { file, name, record } of pages) {
  if (record.keepout_record !== "simulate") continue;
  test(`${name}: what differs, one section and one line of numbers come first`, async () => {
    const tab = await opened(file, large);
    const kinds = await tab.$$eval("main > *", (all) =>
      all.slice(2, 5).map(({ className }) => className),
    );
    assert.deepEqual(kinds, ["differences", "hero", "numbers"]);
    const sources = (selector) =>
      tab.$$eval(`${selector} [data-from]`, (all) => all.map(({ dataset }) => dataset.from));
    const told = await sources(".differences");
    record.runs.forEach(({ rule, summary }, run) => {
      const from = `/runs/${run}/summary`;
      if (rule !== "none") assert.ok(told.includes(`${from}/p50_us`));
      if (rule !== "none" && summary.deepest_mm > 0) assert.ok(told.includes(`${from}/deepest_mm`));
    });
    const best = Math.max(
      record.runs.findIndex(({ rule }) => rule === "certified"),
      0,
    );
    if (best > 0) assert.ok((await sources(".numbers")).includes(`/runs/${best}/summary/cycles`));
    // The first figure has the commanded path and the path of the tool.
    const paths = await tab.$$eval(".hero .name", (all) => all.map((one) => one.textContent));
    assert.match(paths[0], /^commanded path/);
    assert.ok(paths.length > 1);
    assert.deepEqual(tab.faults, []);
    await tab.close();
  });
}

test("a rule has a color, the same on all pages, and others have another", async () => {
  const colors = new Map();
  for (const { file, record } of pages.filter(showsAnatomy)) {
    if (record.keepout_record === "inspect") continue;
    const tab = await opened(file, large);
    const seen = await tab.$$eval(".name", (all) =>
      all
        .filter((one) => one.querySelector(".swatch"))
        .map((one) => [
          one.textContent,
          getComputedStyle(one.querySelector(".swatch")).backgroundColor,
        ]),
    );
    for (const [name, color] of seen) {
      assert.notEqual(color, "rgba(0, 0, 0, 0)", `${name} has no color`);
      assert.equal(colors.get(name) ?? color, color, name);
      colors.set(name, color);
    }
    const here = new Map(seen);
    assert.equal(new Set(here.values()).size, here.size, `two have one color: ${[...here]}`);
    await tab.close();
  }
  assert.ok(colors.size > 2);
});

test("no plot has a single value of x", { skip: given }, async () => {
  const { file, record } = pages.find(({ name }) => name === "bench");
  const sizes = new Map(record.benchmark.rows.map(({ mesh, triangles }) => [mesh, triangles]));
  assert.ok(record.benchmark.rows.every((row) => sizes.get(row.mesh) === row.triangles));
  const tab = await opened(file, large);
  const plots = await tab.$$eval(".plot", (all) => all.map((one) => one.ariaLabel));
  assert.deepEqual(
    plots.filter((label) => label.includes("against the number of")),
    [],
  );
  assert.ok(plots[0].startsWith("Median time of a step with each index"), plots[0]);
  await tab.close();
});

test("a plan has at most two pictures of a mesh", { skip: given }, async () => {
  const { file, record } = pages.find(({ name }) => name === "plan");
  const tab = await opened(file, large);
  const names = await tab.$$eval("figcaption .name", (all) => all.map((one) => one.textContent));
  assert.equal((await tab.$$(".picture")).length, 2 * record.meshes.length);
  assert.ok(names.includes("certified"));
  await tab.close();
});

test("a depth that equals the radius of a body is a lower bound", async () => {
  for (const { file, record } of pages) {
    if (record.keepout_record !== "simulate_robot") continue;
    const tab = await opened(file, large);
    const cells = await tab.$$eval('td[class] [data-from$="_deepest_mm"]', (all) =>
      all.map((one) => [one.dataset.from, one.parentElement.textContent]),
    );
    for (const [from, text] of cells) {
      const { radius_mm } = record.bodies.find(({ name }) => from.endsWith(`/${name}_deepest_mm`));
      const isAll = Math.abs(valueAt(record, from) - radius_mm) <= 1e-5;
      assert.equal(text.startsWith("at least "), isAll, text);
    }
    await tab.close();
  }
});

const experiments = pages.find(({ record }) => record.experiments);
const emulated = isFirefox
  ? onlyChromium("it cannot emulate print and dark media")
  : { skip: given };
test("claims come first; pictures of a record do nothing", emulated, async () => {
  const tab = await opened(experiments.file, large);
  const claimed = await tab.$$eval("main > section:first-of-type tbody th > :first-child", (all) =>
    all.map((one) => one.textContent),
  );
  const claims = experiments.record.experiments.flatMap((one) => one.claims);
  const abouts = claims.map(({ about }) => about);
  assert.deepEqual(claimed, abouts);
  const seen = await tab.$$eval(".picture_of_record", (all) =>
    all.map(({ shadowRoot, textContent }) => {
      const shapes = [...(shadowRoot?.querySelectorAll("*") ?? [])];
      return {
        told: textContent,
        names: shapes.map(({ localName }) => localName),
        attributes: shapes.flatMap((one) => one.getAttributeNames()),
        size: shadowRoot?.querySelector("path")?.getBoundingClientRect().width ?? 0,
        color: shadowRoot ? getComputedStyle(shadowRoot.querySelector("path")).fill : "",
        used: shadowRoot?.querySelector("use")?.getAttribute("href"),
      };
    }),
  );
  const [good, hostile, broken] = seen;
  assert.deepEqual(good.names, ["svg", "title", "style", "path", "use", "text"]);
  assert.ok(good.size > 100, `the path is ${good.size} wide`);
  assert.equal(good.color, "rgb(24, 100, 220)");
  assert.equal(good.used, "#line");
  assert.deepEqual(hostile.names, ["svg", "path", "g", "use"]);
  assert.deepEqual(
    hostile.attributes.filter((name) => /^on|href|^filter$/.test(name)),
    [],
  );
  assert.match(broken.told, /no SVG/);
  assert.equal(await tab.evaluate(() => window.harmed), undefined);
  // The dark scheme has another color. Paper does not.
  const colorNow = () =>
    tab.$eval(
      ".picture_of_record",
      ({ shadowRoot }) => getComputedStyle(shadowRoot.querySelector("path")).fill,
    );
  await tab.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  assert.equal(await colorNow(), "rgb(91, 155, 255)");
  await tab.emulateMediaType("print");
  assert.equal(await colorNow(), "rgb(24, 100, 220)");
  assert.deepEqual(tab.faults, []);
  await tab.close();
});

const inspected = pages.find(({ record }) => record.inspection);
test("faults of a mesh are marked where they are", { skip: given || !inspected }, async () => {
  const { findings } = inspected.record.inspection;
  assert.deepEqual(
    findings.map(({ key, count, groups }) => [key, count, groups]),
    [
      ["inconsistent_edges", 3, 1],
      ["boundary_edges", 3, 1],
      ["degenerate_triangles", 1, 1],
    ],
  );
  const tab = await opened(inspected.file, large);
  await assertDrawn(tab);
  // Each kind of fault has a picture, with a ring around the first fault and red parts around the
  // ring.
  const pictures = await tab.$$(".picture");
  assert.equal(pictures.length, findings.length);
  for (const picture of pictures) {
    const { rings, reds } = await picture.evaluate((one) => {
      const canvas = one.querySelector("canvas");
      const density = canvas.width / one.clientWidth;
      const rings = [...one.querySelectorAll(".ring circle")];
      const pen = canvas.getContext("2d");
      const reds = rings.map((ring) => {
        const [x, y] = ["cx", "cy"].map((name) => density * ring.getAttribute(name));
        const size = 26 * density;
        const { data } = pen.getImageData(x - size / 2, y - size / 2, size, size);
        return data.filter(
          (value, i) => i % 4 === 0 && value > 150 && data[i + 1] < 80 && data[i + 2] < 110,
        ).length;
      });
      return { rings: rings.length, reds };
    });
    assert.equal(rings, 1);
    assert.ok(reds[0] > 5, "nothing red in the ring");
  }
  assert.deepEqual(tab.faults, []);
  await tab.close();
});

test("coordinates have a fixed number of digits", { skip: given || !inspected }, async () => {
  const tab = await opened(inspected.file, large);
  const cells = await tab.$$eval('td[data-from*="/at/"]', (all) =>
    all.map(({ textContent, dataset }) => [textContent, dataset.from]),
  );
  assert.deepEqual(
    cells.filter(([text]) => !/^−?\d+\.\d{4}$/.test(text) || text === "−0.0000"),
    [],
  );
  const tiny = cells.filter(([, from]) => Math.abs(valueAt(inspected.record, from)) < 1e-12);
  assert.ok(tiny.some(([, from]) => valueAt(inspected.record, from) !== 0));
  await tab.close();
});

/** Returns a plate with two small holes close together and one in a corner. */
function plateWithHoles() {
  const [side, holes] = [21, ["10,10", "10,12", "18,2"]];
  const vertex = (i, j) => i * side + j + 1;
  const lines = [];
  for (let i = 0; i < side; ++i) for (let j = 0; j < side; ++j) lines.push(`v ${i} ${j} 0`);
  for (let i = 0; i + 1 < side; ++i) {
    for (let j = 0; j + 1 < side; ++j) {
      if (holes.includes(`${i},${j}`)) continue;
      lines.push(`f ${vertex(i, j)} ${vertex(i + 1, j)} ${vertex(i + 1, j + 1)}`);
      lines.push(`f ${vertex(i, j)} ${vertex(i + 1, j + 1)} ${vertex(i, j + 1)}`);
    }
  }
  return `${lines.join("\n")}\n`;
}

test("each number is at its ring, and close ones share a label", { skip: given }, async () => {
  writeFileSync(join(folder, "plate.obj"), plateWithHoles());
  const tab = await opened(run("plate", "inspect", "plate.obj"), small);
  await assertDrawn(tab);
  const hint = await tab.$eval(".hint", (one) => one.textContent);
  assert.ok(hint.startsWith("Drag to turn. "), hint);
  /** Returns the numbers of the rings in the picture, and the texts of labels beside their rings. */
  const labels = () =>
    tab.$eval(".picture", (picture) => {
      const { clientWidth, clientHeight } = picture;
      const rings = [...picture.querySelectorAll(".ring")].map((ring, number) => {
        const [x, y] = ["cx", "cy"].map((at) => Number(ring.firstChild.getAttribute(at)));
        const isIn = x >= 0 && x <= clientWidth && y >= 0 && y <= clientHeight;
        return { number: number + 1, x, y, isIn, text: ring.lastChild };
      });
      const texts = rings
        .map(({ text }) => text)
        .filter((text) => text.getAttribute("display") !== "none");
      const isBeside = (text, number) => {
        const { x, y } = rings[number - 1];
        const box = text.getBBox();
        const far = [x - box.x - box.width, box.x - x, y - box.y - box.height, box.y - y];
        return Math.max(...far) < 42;
      };
      return {
        inPicture: rings.filter(({ isIn }) => isIn).map(({ number }) => number),
        texts: texts.map(({ textContent }) => textContent),
        apart: texts.flatMap((text) =>
          text.textContent.split(", ").filter((number) => !isBeside(text, Number(number))),
        ),
      };
    });
  const numbersOf = ({ texts }) => texts.flatMap((text) => text.split(", ").map(Number)).sort();
  const all = await labels();
  assert.deepEqual(numbersOf(all), [1, 2, 3, 4]);
  assert.ok(
    all.texts.some((text) => text.includes(", ")),
    `no label is shared: ${all.texts}`,
  );
  assert.deepEqual(all.apart, []);
  await tab.focus(".picture");
  for (let i = 0; i < 12; ++i) await tab.keyboard.press("+");
  await sleep(500);
  const near = await labels();
  assert.ok(near.inPicture.length < 4, "no ring left the picture");
  assert.deepEqual(numbersOf(near), near.inPicture);
  assert.deepEqual(near.apart, []);
  assert.deepEqual(tab.faults, []);
  await tab.close();
});

test("the page of a convex tool names the tool and lower bounds of depths", {
  skip: given,
}, async () => {
  const file = run(
    "whole_tool",
    ..."simulate cube --strokes 1 --cycles 200 --tool capsule:0,0,0:0,0,20:1.5".split(" "),
  );
  const tab = await opened(file, large);
  const text = await tab.$eval("main", (main) => main.textContent);
  assert.match(text, /tool to surface \[mm\]/);
  assert.match(text, /touching or inside, at least this deep/);
  assert.doesNotMatch(text, /tip to surface|inside the anatomy|deepest inside/);
  const depths = text.match(/.{9}[\d.]+\s.m deep/g);
  assert.ok(depths.length > 1);
  assert.deepEqual(
    depths.filter((depth) => !depth.startsWith("at least ")),
    [],
  );
  await assertNumbers(tab, recordOf(file), "body");
  assert.ok((await assertTips(tab, recordOf(file))) > 0);
  assert.deepEqual(tab.faults, []);
  await tab.close();
});

test("the widest table of figures fits a page of 1300 px", { skip: given }, async () => {
  const { record } = pages.find(({ name }) => name === "simulate");
  const wide = { ...record, guides: ["ball:0,0,0:30"] };
  wide.runs = record.runs.map((run) => ({
    ...run,
    summary: {
      ...run.summary,
      ...{ cycles: 24000, limited: 22452, stopped: 15328, cycles_inside: 15328 },
      ...{ guides_left: 13667, farthest_out_mm: 242.123, closest_approach_mm: 0.200123 },
      ...{ p50_us: 21.21, p99_us: 47.61, p999_us: 8112.5, max_us: 12122.1, rate_khz: 1047.2 },
    },
  }));
  writeFileSync(join(folder, "wide.json"), JSON.stringify(wide));
  const tab = await opened(run("wide", "report", "wide.json"), { width: 1300, height: 900 });
  const [needed, available] = await tab.$eval(".scroll", (one) => [
    one.scrollWidth,
    one.clientWidth,
  ]);
  assert.equal(needed, available);
  await tab.close();
});

const bench = pages.find(({ record }) => record.benchmark?.rows.length);
test("the table of all rows is filtered by words", { skip: !bench }, async () => {
  const tab = await opened(bench.file, large);
  await tab.type(".filter input", "wide_bvh certified");
  const rows = await tab.$$eval(".everything tbody tr:not([hidden])", (all) =>
    all.map((row) => row.textContent),
  );
  const expected = bench.record.benchmark.rows.filter(
    ({ index, activation }) => index === "wide_bvh" && activation === "certified",
  );
  assert.equal(rows.length, expected.length);
  assert.ok(rows.every((row) => row.includes("wide_bvh") && row.includes("Certified")));
  await tab.close();
});

test("findings are told, of records without their numbers too", {
  skip: given || !bench,
}, async () => {
  const told = async (tab) =>
    new Set(
      await tab.$$eval(".account [data-from], .account[data-from], .lead [data-from]", (all) =>
        all.map(({ dataset }) => dataset.from),
      ),
    );
  const { fastest, slowest, step_groups, rows } = bench.record.benchmark;
  assert.ok(rows[fastest].step_us.p50 <= rows[slowest].step_us.p50);
  const counts = ["same", "groups", "fewest_steps", "most_steps", "single", "not_verified"];
  assert.ok(step_groups.groups > 0);
  const expected = [
    ...[fastest, slowest].map((row) => `/benchmark/rows/${row}/queries`),
    ...counts.map((count) => `/benchmark/step_groups/${count}`),
    "/benchmark/others_cores",
  ];
  const tab = await opened(bench.file, large);
  const seen = await told(tab);
  assert.deepEqual(
    expected.filter((from) => !seen.has(from)),
    [],
  );
  await tab.close();

  // A record of an older version, which has no such numbers.
  const older = structuredClone(bench.record);
  older.account = ["Medians of 7 steps."];
  delete older.benchmark.fastest;
  delete older.benchmark.slowest;
  delete older.benchmark.step_groups;
  Object.assign(older.benchmark, { account: older.account[0], same_steps: "In 7 of 7 groups." });
  older.comparison.verdict = ["All parts agree that must."];
  older.comparison.indices.verdict = "Of 7 queries, none differs.";
  writeFileSync(join(folder, "older.json"), JSON.stringify(older));
  const old = await opened(run("older", "report", join(folder, "older.json")), large);
  await assertNumbers(old, older, "body");
  assert.ok((await told(old)).has("/account/0"));
  assert.deepEqual(old.faults, []);
  await old.close();
});

after(() => browser.close());
