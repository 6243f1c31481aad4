// SPDX-License-Identifier: BSD-3-Clause
/**
 * Tests the pages of `keepout live`, for a tip and for an instrument, in a browser with real input:
 *
 *   live_pages_test.mjs KEEPOUT JUDGE_PATH FOLDER
 *
 * The pointer drags the tip into the skull. `keepout replay` repeats the path and must give bitwise the
 * same result, and the exact oracle judges it. Further tests drag without a fixture, and drop files. The
 * judge of `keepout verify --robot`, with independent kinematics and distances, judges the paths of an
 * instrument. Touch and keys move both tools as well. The test prints times and rates, but asserts none.
 */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readdirSync, readFileSync, renameSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import { differing, linesOf, replayedPath, stepsText } from "./paths.mjs";
import {
  assertAccessible,
  assertAlone,
  empty,
  firefoxLong,
  isFirefox,
  large,
  launched,
  note,
  onlyLong,
  opened,
  root,
  sleep,
  small,
  textOf,
} from "./tabs.mjs";

const [keepout, judge, folder] = process.argv.slice(2);
const skull = join(process.env.KEEPOUT_CACHE || join(root, ".cache"), "fixtures/skull.stl");
empty(folder);
const run = (program, ...args) =>
  execFileSync(program, args, { encoding: "utf8", cwd: folder, maxBuffer: 1 << 26 });
const judged = (...words) => {
  const verdict = JSON.parse(run(judge, skull, ...words));
  note(JSON.stringify(verdict));
  return verdict;
};
const browser = await launched(folder);
after(() => browser.close());

/** The tabs of the tested page. */
let desk;
let phone;

/** Waits until the page shows a tool and its clearance. */
const ready = (tab) =>
  tab.waitForFunction(
    () =>
      !document.querySelector("#grip").hidden &&
      document.querySelector("#loading").hidden &&
      document.querySelector("#clearance").textContent.endsWith("mm"),
    { timeout: 60_000 },
  );

/** Returns the position of the middle of the grip on the screen. */
const handAt = (tab) =>
  tab.evaluate(() => {
    const { x, y, width, height } = document.querySelector("#grip").getBoundingClientRect();
    return { x: x + width / 2, y: y + height / 2 };
  });

/**
 * Drags the grip along `way`, a function of the fraction that is done; does not release it. A busy machine needs more
 * than these seconds, but the pointer makes the same moves.
 */
async function dragged(seconds, way) {
  const { x, y } = await handAt(desk);
  await desk.mouse.move(x, y);
  await desk.mouse.down();
  const begin = performance.now();
  const moves = 30 * seconds;
  for (let move = 0; move < moves; ++move) {
    const [across, down] = way(move / moves);
    await desk.mouse.move(x + across, y + down);
    await sleep(Math.max(0, begin + (1000 / 30) * move - performance.now()));
  }
}

/** Drags the grip by touch along 50 places. Returns the finger, which has not released it. */
async function touched(way) {
  const { x, y } = await handAt(phone);
  const place = (i) => way(i).map((value, axis) => value + [x, y][axis]);
  const finger = await phone.touchscreen.touchStart(...place(0));
  for (let i = 0; i < 50; ++i) {
    await finger.move(...place(i));
    await sleep(20);
  }
  return finger;
}

/** Waits until the text of an element contains `words`. */
const says = (tab, selector, words, timeout = 30_000) =>
  tab.waitForFunction(
    (where, part) => document.querySelector(where).textContent.includes(part),
    { timeout },
    selector,
    words,
  );

const limitedCycles = async (tab) =>
  Number((await textOf(tab, "#limited")).split(" of ")[0].replaceAll(",", ""));

/** Waits until so many cycles were limited, because a browser may be slow. */
async function comesTo(tab, cycles) {
  for (let i = 0; i < 200 && (await limitedCycles(tab)) < cycles; ++i) await sleep(50);
  assert.ok((await limitedCycles(tab)) >= cycles, "the tool does not reach the anatomy");
}

/** Prints the rates and times of the control loop. */
async function noteRates() {
  const [limited, lost, step, rate, frames] = await Promise.all(
    ["#limited", "#lost", "#step-time", "#rate", "#frames"].map((figure) => textOf(desk, figure)),
  );
  note(
    `limited: ${limited}; lost: ${lost}; a step takes ${step}; ${rate} cycles and ${frames} frames a second`,
  );
}

/** Waits for the end of a replay, and asserts that its path is bitwise identical. */
async function assertReplayed() {
  await says(desk, "#toast", "Replayed", 60_000);
  assert.match(await textOf(desk, "#toast"), /bit for bit/);
}

/** Saves the path by a button of the page. Returns the file, its text and its header. */
async function savedPath(tab = desk) {
  const before = new Set(readdirSync(folder));
  await tab.$eval("#save", (button) => button.click()); // on a phone it may be outside the view
  for (let i = 0; i < 200; ++i) {
    await sleep(50);
    const name = readdirSync(folder).find((one) => !before.has(one) && one.endsWith(".txt"));
    if (name === undefined) continue;
    const text = readFileSync(join(folder, name), "utf8");
    if (text === "") continue; // Firefox makes the file before it fills it
    const file = `path-${before.size}.txt`; // the next one has the same name
    renameSync(join(folder, name), join(folder, file));
    return { file, text, header: JSON.parse(text.match(/^# path: (.*)$/m)[1]) };
  }
  assert.fail("no path was saved");
}

/** Makes a page of the skull, and tests its size. Returns a function that opens the page. */
function testPage(name, when, ...options) {
  const page = `${name}.html`;
  test(`${name}: the page is small, and needs nothing beside it`, when, () => {
    run(keepout, "live", skull, ...options, "--no-open", "--out", page);
    const empty = statSync(join(root, "build/web/live.html")).size;
    note(`page without anatomy ${(empty / 1e3).toFixed(0)} kB`);
    assert.ok(empty <= 1250e3, "the page without anatomy takes more than a second at 10 Mbit/s");
    assertAlone(join(folder, page), 6e6);
  });
  /** Opens the page, and waits until the tool can be dragged. */
  return async (viewport) => {
    const tab = await opened(browser, join(folder, page), viewport);
    await ready(tab);
    return tab;
  };
}

/** The last tests of a page: names of controls, contrast, and no faults reported by the browser. */
function testLooks(name, when) {
  for (const [looks, scheme] of Object.entries({ phone: "dark", light: "light", dark: "dark" })) {
    const options = looks === "phone" ? onlyLong : when;
    test(`${name}: controls have names and contrast holds: ${looks}`, options, async () => {
      const tab = looks === "phone" ? phone : desk;
      await tab.bringToFront();
      await tab.$eval("#save", (button) => button.click()); // shows a toast, which has a plain background
      await assertAccessible(tab, scheme);
      await tab.screenshot({ path: join(folder, `${name}_${looks}.png`) });
    });
  }
  test(`${name}: nothing was complained of`, when, async () => {
    const tabs = [desk, phone].filter(Boolean);
    const faults = tabs.flatMap((tab) => tab.faults);
    await Promise.all(tabs.map((tab) => tab.close()));
    assert.deepEqual(faults, []);
  });
}

/** Moves the grip by a key into the anatomy, where a figure differs from `rest`. Escape releases it. */
async function ledByKeys(key, figure, rest) {
  await desk.click("#again");
  await sleep(500);
  await desk.focus("#view");
  const before = await limitedCycles(desk);
  await desk.keyboard.down(key);
  await comesTo(desk, before + 101);
  await desk.waitForFunction(
    (where, text) => !document.querySelector(where).textContent.startsWith(text),
    {},
    figure,
    rest,
  );
  await desk.keyboard.up(key);
  await desk.keyboard.press("Escape");
  await says(desk, figure, rest);
}

// The page of a tip.

const openTip = testPage("tip", {});

/** Drags the tip's grip into the anatomy, and up and down there. */
async function rub(seconds = 4) {
  await dragged(seconds, (t) => [-200 * Math.min(1, 3 * t), 60 * Math.sin(14 * t)]);
  await desk.mouse.up();
}

/** Runs the command in the head of a path. Returns the rows of STEPS.csv. */
const replayed = (path, mesh, rule) => replayedPath(keepout, folder, path, mesh, rule);

test("a drag into the skull: limited, out of it, and the same as keepout replay", async () => {
  const begin = performance.now();
  desk = await openTip(large);
  note(
    `the tool can be dragged ${((performance.now() - begin) / 1000).toFixed(1)} s after opening`,
  );
  await rub();
  await noteRates();
  const path = await savedPath();
  const lines = linesOf(path);
  const rows = replayed(path, skull, "certified");
  assert.equal(differing(lines, rows), 0, "the page and keepout replay differ");
  const limited = rows.filter((row) => row[1] === "limited").length;
  const { toolRadius, margin } = path.header.settings;
  const kept = toolRadius + margin;
  note(`${lines.length} cycles kept, ${limited} of them limited`);
  const verdict = judged("steps.csv", String(kept));
  // Firefox moves the pointer less often, and a cycle like the one before is left out.
  assert.ok(limited >= (isFirefox ? 300 : 1000), `${limited} limited cycles`);
  assert.deepEqual([verdict.inside, verdict.crossing, verdict.nearer], [0, 0, 0]);
  assert.ok(
    verdict.nearest !== null && verdict.nearest < kept + 0.01,
    "the tip never came to the margin",
  );

  // The page replays the opened path and makes the same motions.
  const field = await desk.$("#file");
  await field.uploadFile(join(folder, path.file));
  await assertReplayed();
});

test(
  "a corridor that is fitted to the tool holds it, as keepout replay does",
  firefoxLong,
  async () => {
    await desk.click("#again");
    await desk.select("#guide", "slab");
    await says(desk, "#guide-state", "inside");
    const [text] = await desk.$eval("#guide-text", (field) => [field.value]);
    await dragged(2, (t) => [-60 * t, 150 * Math.sin(7 * t)]);
    await desk.screenshot({ path: join(folder, "tip_guided.png") });
    await says(desk, "#guide-state", "held by slab");
    await desk.mouse.up();
    const path = await savedPath();
    assert.deepEqual(path.header.settings.guides, [text]);
    const lines = linesOf(path);
    assert.equal(differing(lines, replayed(path, skull, "certified")), 0);
    const [place, normal, [width]] = text
      .split(":")
      .slice(1)
      .map((part) => part.split(",").map(Number));
    const scale = Math.hypot(...normal);
    const out = lines.map((line) => {
      const across = normal.reduce((sum, n, i) => sum + (n * (line[3 + i] - place[i])) / scale, 0);
      return Math.abs(across) - width;
    });
    const farthest = out.reduce((most, one) => Math.max(most, one), -Infinity);
    assert.ok(farthest > -0.01 && farthest < 0.0021, `${farthest} mm out of the corridor`);

    // The page accepts guides in the text field, and rejects text that is no guide.
    const write = async (words) => {
      await desk.$eval("#guide-text", (field) => field.select());
      await desk.type("#guide-text", `${words}\n`);
    };
    await write("ball:1,2");
    await says(desk, "#toast", "the guide 'ball:1,2'");
    assert.equal(await desk.$eval("#guide-text", (field) => field.value), text);
    await write("low=half_space:0,0,-500:0,0,1 wide=ball:0,0,0:900");
    await desk.waitForFunction(() => document.querySelector("#guide").value === "text");
    await says(desk, "#guide-state", "inside");
    await desk.select("#guide", "none");
    await says(desk, "#guide-state", "–");
  },
);

test("the same drag without a fixture goes in", firefoxLong, async () => {
  await desk.click("#rules input[value=none]");
  await desk.click("#again");
  await sleep(500);
  await rub(2);
  writeFileSync(join(folder, "free.csv"), stepsText(linesOf(await savedPath())));
  const verdict = judged("free.csv", "0");
  assert.ok(verdict.inside > 100, `${verdict.inside} motions end inside`);
  assert.ok(verdict.crossing > 0);
  await desk.click("#rules input[value=certified]");
});

test("a tip led by keys", () => ledByKeys("ArrowLeft", "#newtons", "0.00 N"));

/** Returns a function that drops a file with these bytes on the page, by real input. */
async function dropInput() {
  const client = await desk.createCDPSession();
  return async (name, bytes) => {
    writeFileSync(join(folder, name), bytes);
    const data = { items: [], files: [join(folder, name)], dragOperationsMask: 1 };
    for (const type of ["dragEnter", "dragOver", "drop"]) {
      await client.send("Input.dispatchDragEvent", { type, x: 640, y: 400, data });
    }
  };
}

/** Like dropInput(), but by events that the page makes: Firefox's protocol drags no files. */
const dropEvents = () => async (name, bytes) => {
  writeFileSync(join(folder, name), bytes);
  await desk.evaluate(
    async (file, base64) => {
      const content = await (await fetch(`data:;base64,${base64}`)).arrayBuffer();
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([content], file));
      for (const type of ["dragenter", "dragover", "drop"]) {
        document
          .querySelector("#view")
          .dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
      }
    },
    name,
    Buffer.from(bytes).toString("base64"),
  );
};

test(
  "files are dropped: a mesh, then what is none, and the page lives on",
  firefoxLong,
  async () => {
    const drop = isFirefox ? await dropEvents() : await dropInput();
    await drop("my cube.obj", readFileSync(join(root, "tests/install/cube.obj")));
    await desk.waitForFunction(() => document.title.startsWith("my cube.obj"));
    await ready(desk);
    assert.match(await textOf(desk, "#findings"), /12 triangles.*watertight/);

    await drop("broken.stl", readFileSync(skull).subarray(0, 1000));
    await says(desk, "#toast", "broken.stl: ");
    note(await textOf(desk, "#toast"));
    await drop("nonsense.txt", "1 2 3\n");
    await says(desk, "#toast", "nonsense.txt: line 1");
    assert.equal(await desk.title(), "my cube.obj – keepout live");

    const before = await limitedCycles(desk);
    await rub(2);
    const path = await savedPath();
    assert.equal(
      differing(linesOf(path), replayed(path, join(folder, "my cube.obj"), "certified")),
      0,
    );
    const limitedAfter = await limitedCycles(desk);
    await drop("cut.txt", path.text.slice(0, -3));
    await says(desk, "#toast", "cut.txt: the file is cut");
    assert.ok(
      limitedAfter > before + 100,
      `limited cycles: ${before} before, ${limitedAfter} after`,
    );

    // The engine rejects the settings of this path, and the earlier settings stay in use.
    await drop("refused.txt", path.text.replace('"radius":5', '"radius":-1'));
    await says(desk, "#toast", "longer than --radius");
    note(await textOf(desk, "#toast"));
    await desk.waitForFunction(() =>
      document.querySelector("#radius").parentElement.innerText.includes("5 mm"),
    );
  },
);

test("a tip led by touch, on a phone", onlyLong, async () => {
  phone = await openTip(small);
  const finger = await touched((i) => [12 - 2 * i, 20 * Math.sin(i / 6)]);
  assert.ok((await limitedCycles(phone)) > 100, "touch does not move the tip into the skull");
  await finger.end();
});

testLooks("tip", {});

// The page of an instrument.

const openInstrument = testPage("instrument", firefoxLong, "--robot", "psm");

/** Drags the jaws into the forehead and sideways there; does not release them. */
const leadIn = () =>
  dragged(6, (t) => {
    const done = Math.min(1, 3 * t);
    return [-110 * done + 40 * Math.sin(9 * t), 130 * done];
  });

/** Drags the jaws straight into the top of the skull; does not release them. */
const pressIn = () => dragged(1.5, (t) => [-45 * Math.min(1, 3 * t), 60 * Math.min(1, 3 * t)]);

/** Returns the path and its verdict. Fails unless the whole path is clear of the anatomy. */
async function clearPath(tab = desk) {
  const path = await savedPath(tab);
  const verdict = judged(path.file);
  const { jumps, below, limits } = verdict;
  assert.deepEqual([jumps, below, limits], [0, 0, 0]);
  return { path, verdict };
}

test(
  "the jaw dragged into the skull: held back, and all bodies clear, says the judge",
  firefoxLong,
  async () => {
    desk = await openInstrument(large);
    await leadIn();
    assert.equal(await textOf(desk, "#status b"), "limited");
    assert.match(
      await textOf(desk, "#status span"),
      /^The bone stops the (shaft|wrist|jaw): 0\.2\d mm of clearance remains\.$/,
    );
    assert.match(await textOf(desk, "#held"), /^by the (shaft|wrist|jaw)$/);
    assert.match(await textOf(desk, ".callout"), /^(shaft|wrist|jaw) 0\.2\d mm$/);
    assert.match(await textOf(desk, "#clearance"), /^0\.2\d mm$/);
    await desk.screenshot({ path: join(folder, "dragged.png") });
    await desk.mouse.up();
    await noteRates();
    const { path, verdict } = await clearPath();
    assert.equal(verdict.in_mesh, 0);
    assert.ok(verdict.way > 20, `the jaw went ${verdict.way} mm only`);
    assert.ok(verdict.held >= 500, `held back in ${verdict.held} cycles only`);
    assert.ok(verdict.nearest !== null && verdict.nearest >= verdict.kept - 1e-9);

    // Checks the judge itself: with a larger margin it must report breaches.
    const { margin } = path.header;
    const stricter = path.text.replace(`"margin":${margin}`, `"margin":${margin + 0.3}`);
    writeFileSync(join(folder, "stricter.txt"), stricter);
    assert.ok(judged("stricter.txt").below > 0, "the judge sees nothing");

    // The page opens the path again.
    await (await desk.$("#file")).uploadFile(join(folder, path.file));
    await assertReplayed();
    writeFileSync(join(folder, "cut.txt"), path.text.slice(0, -30));
    await (await desk.$("#file")).uploadFile(join(folder, "cut.txt"));
    await says(desk, "#toast", "cut off");
  },
);

test(
  "keys choose the mode while the hand pushes: none goes in, certified does not",
  firefoxLong,
  async () => {
    await desk.click("#again");
    await sleep(500);
    await pressIn();
    await desk.keyboard.press("1");
    await desk.waitForFunction(() => document.querySelector("#status b").textContent === "inside");
    assert.match(await textOf(desk, "#status span"), /deep in the bone: nothing stops it/);
    assert.equal(await desk.$eval(".callout", ({ className }) => className), "callout bad");
    await desk.screenshot({ path: join(folder, "unguarded.png") });
    await desk.mouse.up();
    await sleep(500);
    const depth = await textOf(desk, "#clearance");
    await desk.keyboard.press("3");
    await desk.waitForFunction(() => !document.querySelector("#out").hidden);
    await sleep(500);
    assert.equal(await textOf(desk, "#clearance"), depth, "the depth under the certified rule");
    await desk.click("#out");
    await desk.waitForFunction(() => document.querySelector("#status b").textContent === "free");
    assert.ok(await desk.$eval("#out", ({ hidden }) => hidden));
    await desk.keyboard.press("2");
    await pressIn();
    await desk.waitForFunction(() => document.querySelector("#held").textContent === "by the jaw");
    assert.match(await textOf(desk, "#status span"), /only the tip is guarded/);
    await desk.mouse.up();
    await desk.keyboard.press("3");
    assert.ok(await desk.$eval("#rules input[value=certified]", (radio) => radio.checked));
  },
);

test(
  "the wheel pushes the hand only a little past the jaw, and the page says so",
  firefoxLong,
  async () => {
    await desk.click("#again");
    await sleep(500);
    const { x, y } = await handAt(desk);
    await desk.mouse.move(x, y);
    await desk.mouse.down();
    for (let i = 0; i < 40; ++i) await desk.mouse.wheel({ deltaY: -200 });
    await sleep(2500);
    const ahead = Number.parseFloat(await textOf(desk, "#hand-off"));
    assert.ok(ahead < 25, `the hand is ${ahead} mm ahead of the jaw`);
    if (ahead > 5) assert.match(await textOf(desk, "#whereabouts"), /The hand is behind the bone/);
    await desk.mouse.up();
  },
);

test("a ball about the jaw's end holds it, and bodies stay clear", firefoxLong, async () => {
  await desk.click("#again");
  await desk.select("#guide", "ball");
  await says(desk, "#guide-state", "inside");
  const text = await desk.$eval("#guide-text", (field) => field.value);
  assert.match(text, /^ball=point:6:0,10\.2,0:ball:/);
  await leadIn(2);
  await desk.screenshot({ path: join(folder, "instrument_guided.png") });
  await says(desk, "#guide-state", "held by ball");
  await desk.mouse.up();
  const { path } = await clearPath();
  assert.deepEqual(path.header.guides, [text]);
  await desk.select("#guide", "none");
  await says(desk, "#guide-state", "–");
});

test("it is turned by the wheel and by keys, and the hand with it", onlyLong, async () => {
  await desk.click("#again");
  await sleep(700);
  const { x, y } = await handAt(desk);
  await desk.mouse.move(x, y);
  await desk.mouse.down();
  await desk.keyboard.down("Shift");
  for (let i = 0; i < 20; ++i) await desk.mouse.wheel({ deltaY: 10 });
  await desk.keyboard.up("Shift");
  await sleep(500);
  await desk.keyboard.down("d");
  await sleep(300);
  await desk.keyboard.up("d");
  await sleep(500);
  await desk.mouse.up();
  const { verdict } = await clearPath();
  assert.ok(verdict.turn > 0.5, `turned by ${verdict.turn} rad only`);
});

test("an instrument led by keys, into the skull and out of hand", firefoxLong, () =>
  ledByKeys("ArrowDown", "#hand-off", "0.00 mm"),
);

test("a wider margin is come up to, and kept", onlyLong, async () => {
  await desk.$eval("#margin", (slider) => {
    slider.value = "1";
    slider.dispatchEvent(new Event("input"));
  });
  await desk.waitForFunction(
    () => Number.parseFloat(document.querySelector("#clearance").textContent) > 0.99,
  );
  await leadIn(2);
  await desk.waitForFunction(() =>
    /^(1\.|0\.99)/.test(document.querySelector("#clearance").textContent),
  );
  await desk.mouse.up();
  await clearPath();
});

test("a path is played again, the same in every bit", onlyLong, async () => {
  await desk.click("#replay");
  await assertReplayed();
});

test(
  "an instrument led by touch, on a phone, and turned by a second finger",
  onlyLong,
  async () => {
    phone = await openInstrument(small);
    const { x, y } = await handAt(phone);
    const finger = await touched((i) => [0, 3 * i]);
    await comesTo(phone, 100);
    const second = await phone.touchscreen.touchStart(x + 60, y);
    for (let i = 0; i < 30; ++i) await second.move(x + 60 + 5 * i, y);
    await sleep(500);
    await second.end();
    await finger.end();
    const { verdict } = await clearPath(phone);
    assert.ok(verdict.turn > 0.1, `turned by ${verdict.turn} rad only`);
  },
);

testLooks("instrument", firefoxLong);
