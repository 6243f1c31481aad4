// SPDX-License-Identifier: BSD-3-Clause
/**
 * Tests the instrument of `keepout live --robot` without a browser, with the engine as WebAssembly:
 *
 *   robot_test.mjs BUILD_WASM
 *
 * Each part drawn in the body lies within the capsules that keepout guards, in 40 random poses and openings of the
 * jaws. Without a fixture the instrument enters a box; if only the tip is guarded, the shaft does; certified, no
 * body does. A saved path is read and replayed with bitwise the same joints, and a path that is cut off is refused.
 */
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { packages, root } from "./tabs.mjs";

const built = resolve(process.argv[2]);
const scratch = mkdtempSync(join(tmpdir(), "keepout-robot-"));
process.on("exit", () => rmSync(scratch, { recursive: true, force: true }));

// The modules of the page are in TypeScript, which node cannot read.
const entry = ["engine/keepout", "live/control_loop", "live/robot_parts", "live/robot_path"]
  .concat("live/robot_surroundings")
  .map((file) => `export * from ${JSON.stringify(join(root, `apps/web/src/${file}.ts`))};`)
  .concat('export * as three from "three";');
packages("esbuild").buildSync({
  stdin: { contents: entry.join("\n"), resolveDir: join(root, "apps/web") },
  outfile: join(scratch, "robot.mjs"),
  bundle: true,
  format: "esm",
});
const {
  ControlLoop,
  InstrumentParts,
  loadKeepout,
  parseRobotPath,
  robotPathText,
  SurroundingsFinder,
  three,
  Tool,
} = await import(pathToFileURL(join(scratch, "robot.mjs")));
const { default: instantiate } = await import(pathToFileURL(join(built, "keepout.mjs")));
const keepout = await loadKeepout(instantiate, readFileSync(join(built, "keepout.wasm")));

const base = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
const port = { robot: "psm", base };
const settings = {
  rule: "certified",
  radius: 5,
  toolRadius: 1,
  margin: 0.2,
  maxStep: 0.5,
  guides: [],
  opening: 30,
};
const start = [0, 0, 120, 0, 0, 0];

/** Returns the anatomy of boxes: the middle and half the sides of each. */
function boxes(...all) {
  const vertices = [];
  const corners = [];
  for (const [middle, half] of all) {
    const first = vertices.length / 3;
    for (let i = 0; i < 8; ++i) {
      vertices.push(...middle.map((value, axis) => value + (i & (1 << axis) ? half : -half)));
    }
    const sides = [
      [0, 2, 3, 1],
      [4, 5, 7, 6],
      [0, 1, 5, 4],
      [2, 6, 7, 3],
      [0, 4, 6, 2],
      [1, 3, 7, 5],
    ];
    for (const [a, b, c, d] of sides) corners.push(...[a, b, c, a, c, d].map((i) => first + i));
  }
  return keepout.anatomyOfSurface(Float64Array.from(vertices), Uint32Array.from(corners));
}

/** Returns numbers from 0 to 1, the same in each run. */
function seeded(state) {
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

const far = boxes([[0, 0, 900], 10]);
const began = new Tool(keepout, far, settings, port).place(start);
const at = (numbers, i) => numbers.slice(3 * i, 3 * i + 3);
const along = (from, way, length) => from.map((value, i) => value + length * way[i]);
const difference = (a, b) => a.map((value, i) => value - b[i]);
const unit = (way) => way.map((value) => value / Math.hypot(...way));
/** The direction of the shaft, and one across it. */
const down = unit(difference(at(began.cores, 1), at(began.cores, 0)));
const aside = unit(Math.abs(down[2]) > 0.9 ? [down[2], 0, -down[0]] : [down[1], -down[0], 0]);

/** Returns the pose in which the page draws a cycle. */
function poseOf({ cores, flange }) {
  const point = (i) => new three.Vector3(...at(cores, i));
  const ends = Array.from({ length: cores.length / 6 - 2 }, (_, i) => point(2 * (2 + i) + 1));
  const axis = new three.Vector3(1, 0, 0).applyQuaternion(new three.Quaternion(...flange.turn));
  return { port: point(0), pitch: point(1), yaw: point(3), ends, axis };
}

/** Calls `visit` with each vertex of the drawn parts. */
function eachVertex(groups, visit) {
  for (const group of groups) {
    group.updateMatrixWorld(true);
    group.traverse((part) => {
      if (!(part instanceof three.Mesh)) return;
      const places = part.geometry.getAttribute("position");
      for (let i = 0; i < places.count; ++i) {
        visit(new three.Vector3().fromBufferAttribute(places, i).applyMatrix4(part.matrixWorld));
      }
    });
  }
}

test("what is drawn in the body lies within the guarded bodies", () => {
  const random = seeded(1);
  const limits = [1.5, 0.9, null, 4.5, 1.39, 1.39];
  let nearest = 0;
  for (let pose = 0; pose < 40; ++pose) {
    const opening = pose % 4 === 0 ? 0 : Math.round(60 * random());
    const tool = new Tool(keepout, far, { ...settings, opening }, port);
    const joints = limits.map((most) =>
      most === null ? 60 + 160 * random() : most * (2 * random() - 1),
    );
    const cycle = tool.place(joints);
    const { bodies } = tool.facts;
    assert.equal(bodies.length, opening === 0 ? 3 : 4);
    const parts = new InstrumentParts();
    const places = poseOf(cycle);
    parts.place(places);
    const cores = bodies.map(
      (_, i) =>
        new three.Line3(
          new three.Vector3(...at(cycle.cores, 2 * i)),
          new three.Vector3(...at(cycle.cores, 2 * i + 1)),
        ),
    );
    const closest = new three.Vector3();
    eachVertex(parts.guarded, (vertex) => {
      const room = Math.max(
        ...cores.map(
          (core, i) =>
            bodies[i].radius - core.closestPointToPoint(vertex, true, closest).distanceTo(vertex),
        ),
      );
      assert.ok(room > -1e-6, `${-room} mm outside, with an opening of ${opening} degrees`);
      nearest = Math.max(nearest, 1 - room);
    });
    // All other parts are outside of the body, beyond the port.
    const outwards = places.port.clone().sub(places.pitch).normalize();
    parts.layPort(places.port, outwards);
    eachVertex(parts.unguarded, (vertex) => {
      const depth = -outwards.dot(vertex.clone().sub(places.port));
      assert.ok(depth < 6, `an unguarded part is ${depth} mm deep`);
    });
    tool.made.delete();
  }
  assert.ok(nearest > 0, "nothing was drawn");
});

test("the jaws open by their angle, to both sides of the point that follows the hand", () => {
  for (const opening of [10, 30, 60]) {
    const tool = new Tool(keepout, far, { ...settings, opening }, port);
    const { cores, flange } = tool.place(start);
    const [yaw, a, b] = [4, 5, 7].map((i) => at(cores, i));
    const cosine = unit(difference(a, yaw)).reduce(
      (sum, value, i) => sum + value * unit(difference(b, yaw))[i],
      0,
    );
    assert.ok(Math.abs((Math.acos(cosine) * 180) / Math.PI - opening) < 1e-6);
    const middle = a.map((value, i) => (value + b[i]) / 2);
    const way = unit(difference(middle, yaw));
    const tip = along(yaw, way, 10.2);
    assert.ok(Math.hypot(...difference(tip, flange.place)) < 1e-9);
    tool.made.delete();
  }
});

/** Leads the hand to a place for some cycles. Returns the loop, and the clearances of the bodies. */
function led(anatomy, rule, way, length, cycles = 1200) {
  const loop = new ControlLoop(
    (of) => new Tool(keepout, anatomy, of, port),
    { ...settings, rule },
    start,
  );
  const { flange } = loop.last;
  for (let i = 0; i < cycles; ++i) {
    const share = Math.min(1, (2 * i) / cycles);
    loop.hold({ ...flange, place: along(flange.place, way, share * length) });
    loop.run();
  }
  const clearances = loop.tool.facts.bodies.map((_, i) => loop.tool.made.clearance(i));
  return { loop, clearances };
}

/** A box before the tip, and one beside the shaft. */
const before = boxes([along(began.flange.place, down, 25), 15]);
const beside = boxes([along(along(began.flange.place, down, -50), aside, 22), 15]);

test("without a fixture the instrument enters, and depths do not end at the radius", () => {
  const { loop, clearances } = led(before, "none", down, 24);
  const jaw = Math.min(...clearances.slice(2));
  assert.ok(jaw < -10, `the jaw is ${jaw} mm from the surface`);
  const found = new SurroundingsFinder(before, 60).find(
    loop.tool,
    loop.last,
    loop.hand,
    clearances,
  );
  assert.ok(clearances[found.contact.body] <= jaw + 0.06);
  loop.discard();
});

test("a certified instrument stops before the box, and the contact is marked on it", () => {
  const { loop, clearances } = led(before, "certified", down, 24);
  assert.ok(Math.min(...clearances) > 0.1, `clearances ${clearances}`);
  assert.ok(Math.min(...clearances) < 0.3, "it does not come to the box");
  const around = new SurroundingsFinder(before, 60).find(
    loop.tool,
    loop.last,
    loop.hand,
    clearances,
  );
  assert.ok(around.contact.body >= 2, "the jaw stops it");
  const { core, surface } = around.contact;
  const gap = Math.hypot(...difference(core, surface)) - loop.tool.facts.bodies[2].radius;
  assert.ok(Math.abs(gap - clearances[around.contact.body]) < 0.06, `the mark is ${gap} mm away`);
  assert.ok(around.isHandBehind, "the hand is in the box");
  assert.ok(!around.isEnclosed);
  loop.discard();
});

test("only the certified mode keeps the shaft out; the tip mode keeps the tip out", () => {
  const tip = led(before, "tip_only", down, 24);
  const ball = before.clearance(...tip.loop.last.flange.place) - 1;
  assert.ok(ball > 0.1 && ball < 0.4, `the tip's ball is ${ball} mm from the box`);
  assert.ok(tip.loop.last.byMesh && tip.loop.last.held > 0);
  const leaning = led(beside, "tip_only", aside, 60);
  assert.ok(leaning.clearances[0] < -1, `the shaft is ${leaning.clearances[0]} mm from the box`);
  const certified = led(beside, "certified", aside, 60);
  assert.ok(Math.min(...certified.clearances) > 0.1, `clearances ${certified.clearances}`);
  assert.equal(certified.loop.last.nearest, 0);
  for (const { loop } of [tip, leaning, certified]) loop.discard();
});

test("a body wholly inside a solid is as deep under the certified rule as without a fixture", () => {
  const solid = boxes([began.flange.place, 60]);
  const [none, certified] = ["none", "certified"].map((rule) => {
    const { loop, clearances } = led(solid, rule, down, 0, 1);
    loop.discard();
    return clearances;
  });
  assert.deepEqual(certified, none);
  const jaw = certified.at(-1);
  assert.ok(jaw < -30, `the jaw is ${jaw} mm from the surface`);
});

test("a point in the hollow of a shell is enclosed, and one beside it is not", () => {
  const shell = boxes([began.flange.place, 60], [began.flange.place, 40]);
  const tool = new Tool(keepout, shell, { ...settings, rule: "none" }, port);
  const cycle = tool.place(start);
  const rest = { place: cycle.flange.place, turn: cycle.flange.turn };
  assert.ok(new SurroundingsFinder(shell, 210).find(tool, cycle, rest, [1]).isEnclosed);
  tool.made.delete();
  const other = new Tool(keepout, before, settings, port);
  const { isEnclosed } = new SurroundingsFinder(before, 60).find(
    other,
    other.place(start),
    rest,
    [1],
  );
  assert.ok(!isEnclosed);
  other.made.delete();
});

for (const rule of ["none", "tip_only", "certified"]) {
  test(`a saved path is replayed with the same joints, bit for bit: ${rule}`, () => {
    const { loop } = led(before, rule, unit(along(down, aside, 0.4)), 22, 600);
    const text = robotPathText(
      { keepout: "test", robot: "psm" },
      loop.settings,
      { command_name: "box", digest: "0" },
      base,
      loop.tool.facts,
      loop.record.lines(),
    );
    const { header, lines } = parseRobotPath(text, { ...settings, margin: 9, rule: "none" });
    assert.deepEqual(header.settings, loop.settings);
    assert.deepEqual([header.mesh, header.digest, header.base], ["box", "0", base]);
    const again = new ControlLoop(
      (of) => new Tool(keepout, before, of, port),
      header.settings,
      start,
    );
    again.startReplay(lines);
    let end = null;
    while (end === null) end = again.run();
    assert.equal(end.differs, -1);
    assert.equal(end.cycles, lines.length / 18);
    assert.deepEqual(again.last.positions, loop.last.positions);

    for (const cut of [text.slice(0, -40), text.slice(0, -1), "1 2 3\n"]) {
      assert.throws(() => parseRobotPath(cut, settings), Error);
    }
    for (const one of [loop, again]) one.discard();
  });
}
