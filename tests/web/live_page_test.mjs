// SPDX-License-Identifier: BSD-3-Clause
/**
 * The page of `keepout live`, in a real browser and with real input:
 *
 *   live_page_test.mjs KEEPOUT JUDGE_PATH FOLDER [BROWSER]
 *
 * A hand drags into the skull; what the page's tool did is done again by `keepout replay`, as the
 * page says, and must be the same in every bit; the exact oracle judges it. Then without a fixture,
 * with files that are dropped, by touch and by keys. Prints times and rates, and asserts none.
 */
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import {
  assertReplayed,
  dragged,
  handAt,
  limitedCycles,
  livePage,
  noteRates,
  ready,
  savedPath,
  skull,
  testLooks,
  textOf,
} from "./live_tab.mjs";
import { large, note, root, sleep, small } from "./tabs.mjs";

const { keepout, judge, folder, run, open } = await livePage();

/** Pushes the hand into the anatomy and rubs it up and down there. */
async function dragIn(tab, seconds = 4) {
  await dragged(tab, seconds, (t) => [-130 * Math.min(1, 3 * t), 60 * Math.sin(14 * t)]);
  await tab.mouse.up();
}

/** Numbers of the lines of a path. */
const linesOf = (file) =>
  readFileSync(join(folder, file), "utf8")
    .split("\n")
    .filter((line) => line !== "" && !line.startsWith("#"))
    .map((line) => line.split(" ").map(Number));

/** What a path was made with. */
const headOf = (file) =>
  JSON.parse(readFileSync(join(folder, file), "utf8").match(/^# path: (.*)$/m)[1]);

/** Types what the head of a path says, and gives the rows of STEPS.csv. */
function replayed(file, mesh, rule) {
  const line = readFileSync(join(folder, file), "utf8")
    .split("\n")
    .find((text) => text.startsWith("#   keepout replay "));
  const words = line
    .match(/'[^']*'|\S+/g)
    .slice(2) // past "# keepout"
    .map((word) => ({ THIS_FILE: file, RULE: rule })[word] ?? word);
  words[1] = mesh;
  run(keepout, ...words);
  const [, ...rows] = readFileSync(join(folder, "steps.csv"), "utf8").trim().split("\n");
  return rows.map((row) => row.split(","));
}

/** How many cycles of a path have another tool than replay has, in any bit. */
function differing(lines, rows) {
  assert.equal(rows.length, lines.length);
  return lines.filter((line, i) =>
    [0, 1, 2].some((axis) => !Object.is(line[3 + axis], Number(rows[i][2 + axis]))),
  ).length;
}

let desk; // the page that most tests go on with
let phone;

test("a drag into the skull: limited, out of it, and the same as keepout replay", async () => {
  const begin = performance.now();
  desk = await open(large);
  note(
    `the tool can be dragged ${((performance.now() - begin) / 1000).toFixed(1)} s after opening`,
  );
  await dragIn(desk);
  await noteRates(desk);
  const path = await savedPath(desk, folder);
  const lines = linesOf(path);
  const rows = replayed(path, skull, "certified");
  assert.equal(differing(lines, rows), 0, "the page and keepout replay differ");
  const limited = rows.filter((row) => row[1] === "limited").length;
  const { toolRadius, margin } = headOf(path).settings;
  const kept = toolRadius + margin;
  const verdict = JSON.parse(run(judge, skull, "steps.csv", String(kept)));
  note(`${lines.length} cycles kept, ${limited} of them limited: ${JSON.stringify(verdict)}`);
  assert.ok(limited >= 1000, `${limited} limited cycles`);
  assert.deepEqual([verdict.inside, verdict.crossing, verdict.nearer], [0, 0, 0]);
  assert.ok(
    verdict.nearest !== null && verdict.nearest < kept + 0.01,
    "it never came to the margin",
  );

  // Opened again, the path is played, and goes the same way.
  const file = await desk.$("#file");
  await file.uploadFile(join(folder, path));
  await assertReplayed(desk);
});

test("the same drag without a fixture goes in", async () => {
  await desk.click("#rules input[value=none]");
  await desk.click("#again");
  await sleep(500);
  await dragIn(desk, 2);
  const rows = linesOf(await savedPath(desk, folder));
  // As replay would write what happened: from tip to tip.
  const steps = rows.slice(1).map((line, i) => {
    const tip = rows[i].slice(3);
    const motion = tip.map((value, axis) => line[3 + axis] - value);
    return [i, "free", ...tip, ...motion, ...motion].join(",");
  });
  writeFileSync(join(folder, "free.csv"), `head\n${steps.join("\n")}\n`);
  const verdict = JSON.parse(run(judge, skull, "free.csv", "0"));
  note(JSON.stringify(verdict));
  assert.ok(verdict.inside > 100, `${verdict.inside} motions end inside`);
  assert.ok(verdict.crossing > 0);
  await desk.click("#rules input[value=certified]");
});

test("led by keys", async () => {
  await desk.click("#again");
  await sleep(500);
  const before = await limitedCycles(desk);
  await desk.focus("#view");
  for (const key of ["ArrowLeft", "PageUp"]) {
    await desk.keyboard.down(key);
    await sleep(key === "PageUp" ? 300 : 1000);
    await desk.keyboard.up(key);
  }
  assert.ok((await limitedCycles(desk)) > before + 100, "keys do not lead into the skull");
  await desk.waitForFunction(() => document.querySelector("#newtons").textContent !== "0.00 N");
  await desk.keyboard.press("Escape");
  await desk.waitForFunction(() => document.querySelector("#newtons").textContent === "0.00 N");
});

test("counterexamples: the paper's rule goes through, the certified one stays out", async () => {
  await desk.click("#fail");
  await desk.waitForSelector("#failures[open] #examples button");
  const examples = await desk.$$("#examples button");
  assert.equal(examples.length, 3);
  for (const example of examples) {
    await example.click();
    const captions = await desk.$$eval("#duel figcaption span", (all) =>
      all.map((one) => one.textContent),
    );
    assert.deepEqual(captions, ["goes through the surface", "stays out"]);
  }
  await desk.click("#failures .close");
});

test("files are dropped: a mesh, then what is none, and the page lives on", async () => {
  const client = await desk.createCDPSession();
  const drop = async (file) => {
    const data = { items: [], files: [file], dragOperationsMask: 1 };
    for (const type of ["dragEnter", "dragOver", "drop"]) {
      await client.send("Input.dispatchDragEvent", { type, x: 640, y: 400, data });
    }
  };
  const told = (words) =>
    desk.waitForFunction(
      (part) => document.querySelector("#toast").textContent.includes(part),
      {},
      words,
    );
  const cube = join(folder, "my cube.obj");
  writeFileSync(cube, readFileSync(join(root, "tests/install/cube.obj")));
  await drop(cube);
  await desk.waitForFunction(() => document.title.startsWith("my cube.obj"));
  await ready(desk);
  assert.match(await textOf(desk, "#findings"), /12 triangles.*watertight/);

  const broken = join(folder, "broken.stl");
  writeFileSync(broken, readFileSync(skull).subarray(0, 1000));
  await drop(broken);
  await told("broken.stl: ");
  note(await textOf(desk, "#toast"));
  const nonsense = join(folder, "nonsense.txt");
  writeFileSync(nonsense, "1 2 3\n");
  await drop(nonsense);
  await told("nonsense.txt: line 1");
  assert.equal(await desk.title(), "my cube.obj – keepout live");

  const before = await limitedCycles(desk);
  await dragIn(desk, 2);
  const path = await savedPath(desk, folder);
  assert.equal(differing(linesOf(path), replayed(path, cube, "certified")), 0);
  const limitedAfter = await limitedCycles(desk);
  assert.ok(limitedAfter > before + 100, `limited cycles: ${before} before, ${limitedAfter} after`);

  // A path whose settings the engine refuses: those before stay in force.
  const text = readFileSync(join(folder, path), "utf8");
  writeFileSync(join(folder, "refused.txt"), text.replace('"radius":5', '"radius":-1'));
  await drop(join(folder, "refused.txt"));
  await told("longer than --radius");
  note(await textOf(desk, "#toast"));
  await desk.waitForFunction(() =>
    document.querySelector("#radius").parentElement.innerText.includes("5 mm"),
  );
});

test("led by touch, on a phone", async () => {
  phone = await open(small);
  const { x, y } = await handAt(phone);
  await phone.touchscreen.touchStart(x + 12, y);
  for (let i = 0; i < 50; ++i) {
    await phone.touchscreen.touchMove(x + 12 - 2 * i, y + 20 * Math.sin(i / 6));
    await sleep(20);
  }
  assert.ok((await limitedCycles(phone)) > 100, "touch does not lead into the skull");
  await phone.touchscreen.touchEnd();
});

testLooks(folder, () => ({ desk, phone }));
