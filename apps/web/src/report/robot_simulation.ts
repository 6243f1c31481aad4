// SPDX-License-Identifier: BSD-3-Clause
/** The sections of a simulation with a whole instrument: docs/records.md. */

import * as three from "three";
import { make } from "../page/elements.ts";
import { type Anatomy, lookAtAll, type Outlook, unpackedAnatomy, verticesOf } from "./anatomy.ts";
import { AnatomyView, hint } from "./anatomy_view.ts";
import type { Body, Layer } from "./painting.ts";
import { entries, type ReportRecord, valueAt } from "./record.ts";
import { differences, lead, section } from "./report_page.ts";
import { pictureGrid, ruleColor, swatched } from "./runs.ts";
import { counted, deep, listed, millimetres, ruleName, show, shown } from "./shown.ts";
import type { Place, RecordedMesh } from "./simulation_record.ts";
import { type Column, column, harm, named, tableSection } from "./table.ts";
import { strokeChooser, timeSlider } from "./time_slider.ts";

interface Run {
  readonly mode: string;
  readonly worst: number;
  readonly places: readonly (readonly Place[])[];
  /** The other ends of the bodies, if a body does not begin where the one before ends. */
  readonly begins?: readonly (readonly Place[])[];
  readonly clearance_mm: readonly (readonly (number | null)[])[];
}
interface Stroke {
  readonly port: Place;
  readonly runs: readonly Run[];
}
interface RobotSimulationRecord extends ReportRecord {
  readonly bodies: readonly { readonly name: string; readonly radius_mm: number }[];
  readonly meshes: readonly (RecordedMesh & { readonly strokes: readonly Stroke[] })[];
}

/** Shows the page of `simulate --robot`. */
export async function robotSimulationSections(
  main: HTMLElement,
  record: ReportRecord,
): Promise<void> {
  const simulation = record as RobotSimulationRecord;
  main.append(...differences(...reached()));
  for (const mesh of simulation.meshes.keys()) main.append(await meshSection(simulation, mesh));
  main.append(figures(simulation));
}

/** Returns for each mode, at each speed, the cycles in which the mesh reached in or was too close, on the first mesh. */
function reached(): (Node | string)[][] {
  const rows = entries("/rows").filter((row) => valueAt(`${row}/mesh`) === valueAt("/rows/0/mesh"));
  const modes = new Set(rows.map((row) => valueAt<string>(`${row}/mode`)));
  return [...modes].map((mode) => {
    const own = rows.filter((row) => valueAt(`${row}/mode`) === mode);
    const cyclesOf = (key: string, rows: readonly string[]) =>
      rows.map((row) => [
        ...counted(`${row}/${key}`, "cycle"),
        " at speed ",
        shown(`${row}/speed`),
      ]);
    const has = (row: string, key: string) => Number(valueAt(`${row}/${key}`)) > 0;
    const inside = own.filter((row) => has(row, "in_mesh"));
    const near = own.filter((row) => !inside.includes(row) && has(row, "below"));
    const parts = [
      inside.length > 0
        ? ["the mesh reached into the instrument in ", ...listed(cyclesOf("in_mesh", inside))]
        : [],
      near.length > 0
        ? ["a body was too close, but not in the mesh, in ", ...listed(cyclesOf("below", near))]
        : [],
    ].filter((part) => part.length > 0);
    if (parts.length === 0) return [];
    return ["In mode ", shown(`${own[0]}/mode`), ", ", ...listed(parts), "."];
  });
}

/** True if some depth is larger than the radius of its body, so that no radius limits the depths. */
const isUnlimited = ({ bodies }: RobotSimulationRecord): boolean =>
  entries("/rows").some((row) =>
    bodies.some(
      ({ name, radius_mm }) => Number(valueAt(`${row}/${name}_deepest_mm`)) > radius_mm + 1e-5,
    ),
  );

/** True if a depth is the radius of its body, which limits depths: the real depth may be larger. */
const isAll = (depth: number, radius: number): boolean => Math.abs(depth - radius) <= 1e-5;

/** Returns the content of a cell with a depth. */
function depthOf(from: string, radius: number): (Node | string)[] {
  const depth = Number(valueAt(from));
  return [...(isAll(depth, radius) ? ["at least "] : []), shown(from, millimetres)];
}

function figures(record: RobotSimulationRecord): HTMLElement {
  const { bodies } = record;
  const columns: Column[] = [
    { heading: "mesh", from: "/mesh" },
    { heading: "speed", from: "/speed" },
    named("mode", "/mode"),
    column("cycles", "/cycles"),
    ...(valueAt("/rows/0/guides_left") === undefined ? [] : [harm("guides left", "/guides_left")]),
    ...bodies.flatMap(({ name, radius_mm }) => [
      harm(`${name}: too close`, `/${name}_below`),
      harm("in the mesh", `/${name}_in_mesh`),
      {
        ...harm("deepest", `/${name}_deepest_mm`),
        content: (row: string) => depthOf(`${row}/${name}_deepest_mm`, radius_mm),
      },
      ...(valueAt(`/rows/0/${name}_error_mm`) === undefined
        ? []
        : [
            { heading: "least", from: `/${name}_least_mm`, format: millimetres },
            { heading: "from setpoint", from: `/${name}_error_mm`, format: millimetres },
          ]),
    ]),
  ];
  return tableSection(
    "The figures",
    [
      "Cycles in which a body was closer than what is certified, ",
      shown("/certified_mm", millimetres),
      "; of them those in which the mesh reached into it; and how far. An independent judge examines several poses of each cycle.",
      isUnlimited(record)
        ? ""
        : " A depth is at most the body's radius, and a body wholly behind the surface counts as clear.",
    ],
    entries("/rows"),
    columns,
  );
}

/** Returns the most informative strokes on one mesh. */
async function meshSection(record: RobotSimulationRecord, number: number): Promise<HTMLElement> {
  const mesh = record.meshes[number] as RobotSimulationRecord["meshes"][number];
  const anatomy = await unpackedAnatomy(mesh);
  const strokes = entries(`/meshes/${number}/strokes`);
  const option = (value: number, from: string) =>
    show(make("option", { value: String(value) }), from);
  const moment = make("select", { "aria-label": "moment" });
  const range = make(
    "select",
    { "aria-label": "view" },
    make(
      "option",
      { value: "whole" },
      `the whole anatomy and the ${hasPort(mesh.strokes[0]) ? "port" : "base"}`,
    ),
    make("option", { value: "tip" }, "the tip"),
  );
  const content = make("div");
  const runs = entries(`${strokes[0]}/runs`);
  moment.append(...runs.map((from, run) => option(run, `${from}/mode`)));
  moment.value = String(Math.max(runs.length - 2, 0));
  let view: ReturnType<typeof strokeView> | null = null;
  const options = strokes.map((from, stroke) => option(stroke, `${from}/manner`));
  const chooser = strokeChooser(options, 0, (stroke) => {
    const chosen = mesh.strokes[stroke] as Stroke;
    const outlook = range.value === "whole" ? wholeView : tipView;
    view = strokeView(record, anatomy, chosen, strokes[stroke] as string, outlook(anatomy, chosen));
    content.replaceChildren(view.element);
    view.go(Number(moment.value));
    return view;
  });
  moment.addEventListener("change", () => view?.go(Number(moment.value)));
  range.addEventListener("change", () => chooser.dispatchEvent(new Event("change")));
  return section(
    shown(`/meshes/${number}/name`),
    lead(
      "Stroke: ",
      chooser,
      ", at first at the worst moment of ",
      moment,
      ". Shown: ",
      range,
      ". ",
      make("b", {}, "Red"),
      " is the body that the mesh reaches into farthest. A pale part is hidden by the surface. ",
      hasPort(mesh.strokes[0])
        ? "The gray ball is the port; the shaft above it is not guarded."
        : "The gray ball is the origin of the base.",
    ),
    content,
    hint(runs.length),
  );
}

/** True if the first body begins in a port, and each other one where the body before it ends. */
const hasPort = (stroke: Stroke | undefined): boolean => stroke?.runs[0]?.begins === undefined;

/** Returns the ends of the instrument's bodies in a cycle: the port, and the end of each body. */
const ends = ({ port }: Stroke, run: Run, cycle: number, { placed }: Anatomy): three.Vector3[] =>
  [port, ...(run.places[cycle] ?? [])].map(placed);

/** Returns a stroke in all modes, side by side, with the views that follow it in time. */
function strokeView(
  { bodies }: RobotSimulationRecord,
  anatomy: Anatomy,
  stroke: Stroke,
  from: string,
  outlook: Outlook,
) {
  const group = pictureGrid(stroke.runs.length);
  const view = new AnatomyView(group, anatomy, anatomy.corners, outlook);
  const followed = stroke.runs.map((run, number) => {
    const layer: Layer = { lengths: [], cut: null };
    const now = make("span", { class: "now" });
    const name = swatched(ruleColor(run.mode), shown(`${from}/runs/${number}/mode`));
    view.add(`The instrument beside the anatomy, ${ruleName(run.mode)}.`, layer, [], name, now);
    return (cycle: number) => {
      const clearances = (run.clearance_mm[cycle] ?? []).map(
        (mm) => mm ?? Number.POSITIVE_INFINITY,
      );
      const least = Math.min(...clearances);
      const nearest = clearances.indexOf(least);
      const places = ends(stroke, run, cycle, anatomy);
      layer.bodies = bodies.map(({ radius_mm }, body): Body => {
        const isDeepest = least < 0 && body === nearest;
        const begin = run.begins?.[cycle]?.[body];
        return {
          from: begin ? anatomy.placed(begin) : (places[body] as three.Vector3),
          to: places[body + 1] as three.Vector3,
          radius: radius_mm,
          color: isDeepest ? "--alarm" : ruleColor(run.mode),
          hidden: isDeepest ? 0.6 : 0.2,
        };
      });
      layer.bodies = [...layer.bodies, ...portMarks(places, hasPort(stroke))];
      const at = `${from}/runs/${number}/clearance_mm/${cycle}/${nearest}`;
      const how = (mm: number) => (mm < 0 ? deep(mm) : millimetres(mm));
      if (Number.isFinite(least)) {
        const radius = bodies[nearest]?.radius_mm ?? Number.POSITIVE_INFINITY;
        const extent = isAll(-least, radius) ? " at least " : " ";
        now.replaceChildren(shown(`/bodies/${nearest}/name`), extent, shown(at, how));
      } else now.replaceChildren("clear");
    };
  });
  const about = make("p", { class: "hint" }, "At speed ", shown(`${from}/speed`), ".");
  const cycles = stroke.runs[0]?.places.length ?? 1;
  const time = timeSlider(view, `${from}/runs/0/places`, cycles, (cycle) => {
    for (const follow of followed) follow(cycle);
    view.outdate();
  });
  return {
    element: make("div", {}, group, time.element, about),
    go: (run: number) => time.go(stroke.runs[run]?.worst ?? 0),
    dispose: time.dispose,
  };
}

/** The length of the drawn shaft above the port, and the radii of both marks. [mm] */
const [abovePort, shaftRadius, portRadius] = [45, 4, 7];

/** Returns the marks of the port, and the shaft above it; without a port only the mark of the base. */
function portMarks([port, wrist]: readonly three.Vector3[], isPort: boolean): Body[] {
  if (port === undefined || wrist === undefined) return [];
  const gray = { color: "--soft", hidden: 0.1 };
  const mark = { from: port, to: port, radius: portRadius, ...gray };
  if (!isPort) return [mark];
  const up = port.clone().sub(wrist).setLength(abovePort).add(port);
  return [mark, { from: port, to: up, radius: shaftRadius, ...gray }];
}

/** Views the whole anatomy with the port, from the front, turned to the side of the tip. */
function wholeView(anatomy: Anatomy, stroke: Stroke): Outlook {
  const up = new three.Vector3(0, 0, 1);
  const places = verticesOf(anatomy).filter((_, i) => i % 50 === 0);
  const middle = new three.Box3().setFromPoints(places).getCenter(new three.Vector3());
  const [port, tip] = [anatomy.placed(stroke.port), lastPlace(anatomy, stroke)];
  places.push(port, port.clone().sub(tip).setLength(abovePort).add(port), tip);
  const aside = tip.sub(middle).setZ(0);
  const toward = new three.Vector3(-0.15, 0.95, 0.28);
  if (aside.lengthSq() > 0) toward.addScaledVector(aside.normalize(), 0.35);
  return lookAtAll(places, toward.normalize(), up, anatomy);
}

/** Returns the place of the tip at the end of the first mode. */
const lastPlace = ({ placed }: Anatomy, { port, runs }: Stroke): three.Vector3 =>
  placed(runs[0]?.places.at(-1)?.at(-1) ?? port);

/** Views the tip in all modes, obliquely along the shaft. */
function tipView(anatomy: Anatomy, stroke: Stroke): Outlook {
  const up = new three.Vector3(0, 0, 1);
  const places = stroke.runs.flatMap((run) =>
    run.places.flatMap((_, cycle) =>
      cycle % 10 === 0 ? ends(stroke, run, cycle, anatomy).slice(1) : [],
    ),
  );
  const [port, wrist] = [anatomy.placed(stroke.port), places[0] as three.Vector3];
  places.push(port.clone().lerp(wrist, 0.6));
  const axis = port.clone().sub(wrist).normalize();
  const side = axis.clone().cross(up).normalize();
  const toward = axis.addScaledVector(side, 1.2).normalize();
  return lookAtAll(places, toward, up, anatomy, 1.9);
}
