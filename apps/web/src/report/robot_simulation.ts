// SPDX-License-Identifier: BSD-3-Clause
/** The sections of a simulation with a whole instrument: docs/records.md. */
import * as three from "three";
import { type Anatomy, coarsened, fitted, lookFrom, unpackedAnatomy } from "./anatomy.ts";
import { AnatomyView, bestDirection, hint } from "./anatomy_view.ts";
import type { Capsule } from "./capsules.ts";
import type { Layer } from "./painting.ts";
import { entries, type ReportRecord } from "./record.ts";
import { lead, section } from "./report_page.ts";
import { pictureGrid, runColor } from "./runs.ts";
import { grouped, make, millimetres, rounded, show, shown } from "./shown.ts";
import type { Place, RecordedMesh } from "./simulation_record.ts";
import { seen } from "./still.ts";
import { type Column, scrolled, table } from "./table.ts";
import { timeSlider } from "./time_slider.ts";

interface Run {
  readonly mode: string;
  readonly worst: number;
  readonly places: readonly (readonly number[])[];
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

/** What the page of `simulate --robot` shows. */
export async function robotSimulationSections(
  main: HTMLElement,
  record: ReportRecord,
): Promise<void> {
  const simulation = record as RobotSimulationRecord;
  main.append(figures(simulation));
  for (const mesh of simulation.meshes.keys()) main.append(await meshSection(simulation, mesh));
}

function figures({ bodies }: RobotSimulationRecord): HTMLElement {
  const columns: Column[] = [
    { heading: "mesh", from: "/mesh" },
    { heading: "speed", from: "/speed" },
    { heading: "mode", from: "/mode", look: "name" },
    { heading: "cycles", from: "/cycles", format: grouped },
    ...bodies.flatMap(({ name }): Column[] => [
      { heading: `${name}: too close`, from: `/${name}_below`, format: grouped, look: "harm" },
      { heading: "in the mesh", from: `/${name}_in_mesh`, format: grouped, look: "harm" },
      {
        heading: "deepest [mm]",
        from: `/${name}_deepest_mm`,
        format: (mm) => rounded(mm, 2),
        look: "harm",
      },
    ]),
  ];
  return section(
    "The figures",
    lead(
      "Cycles in which a body was closer than what is certified, ",
      shown("/certified_mm", millimetres),
      "; of them those in which the mesh reached into it; and how far, which is at most the body's radius. An independent judge sees several poses of each cycle. A body that is all behind the surface, farther than its radius, counts as clear.",
    ),
    scrolled(table(entries("/rows"), columns)),
  );
}

/** The strokes on one mesh that say most. */
async function meshSection(record: RobotSimulationRecord, number: number): Promise<HTMLElement> {
  const mesh = record.meshes[number] as RobotSimulationRecord["meshes"][number];
  const anatomy = await unpackedAnatomy(mesh);
  const strokes = entries(`/meshes/${number}/strokes`);
  const option = (value: number, from: string) =>
    show(make("option", { value: String(value) }), from);
  const chooser = make("select", { "aria-label": "stroke" });
  chooser.append(...strokes.map((from, stroke) => option(stroke, `${from}/manner`)));
  const moment = make("select", { "aria-label": "moment" });
  const content = make("div");
  const runs = entries(`${strokes[0]}/runs`);
  moment.append(...runs.map((from, run) => option(run, `${from}/mode`)));
  moment.value = String(Math.max(runs.length - 2, 0));
  let view: ReturnType<typeof strokeView> | null = null;
  const choose = () => {
    view?.dispose();
    const stroke = Number(chooser.value);
    view = strokeView(record, anatomy, mesh.strokes[stroke] as Stroke, strokes[stroke] as string);
    content.replaceChildren(view.element);
    view.go(Number(moment.value));
  };
  chooser.addEventListener("change", choose);
  moment.addEventListener("change", () => view?.go(Number(moment.value)));
  if (strokes.length > 0) choose();
  const title = section(
    "",
    lead(
      "Stroke: ",
      chooser,
      ", at first at the worst moment of ",
      moment,
      ". ",
      make("b", {}, "Red"),
      " is the body that the mesh reaches into farthest, also where the surface hides it.",
    ),
    content,
    hint(),
  );
  (title.firstChild as HTMLElement).append(shown(`/meshes/${number}/name`));
  return title;
}

/** The bodies of an instrument in a cycle: from the port, and from each body's end to the next. */
const ends = (stroke: Stroke, run: Run, cycle: number, { placed }: Anatomy): three.Vector3[] => {
  const flat = run.places[cycle] ?? [];
  const places = [0, 1, 2].map((b) => placed(flat.slice(3 * b, 3 * b + 3) as unknown as Place));
  return [placed(stroke.port), ...places];
};

/** A stroke in all modes, side by side, and what follows it in time. */
function strokeView(
  { bodies }: RobotSimulationRecord,
  anatomy: Anatomy,
  stroke: Stroke,
  from: string,
) {
  const group = pictureGrid(stroke.runs.length);
  const view = new AnatomyView(group, anatomy, anatomy.corners, outlook(anatomy, stroke));
  const followed = stroke.runs.map((run, number) => {
    const layer: Layer = { lengths: [], cut: null };
    const now = make("span", { class: "now" });
    const style = `--color: var(${runColor(number)})`;
    const mode = shown(`${from}/runs/${number}/mode`);
    const name = make("span", { class: "name", style }, make("span", { class: "swatch" }), mode);
    const picture = view.picture(`The instrument beside the anatomy, ${run.mode}.`, layer, []);
    group.append(make("figure", {}, picture, make("figcaption", {}, name, now)));
    return (cycle: number) => {
      const clearances = (run.clearance_mm[cycle] ?? []).map(
        (mm) => mm ?? Number.POSITIVE_INFINITY,
      );
      const least = Math.min(...clearances);
      const nearest = clearances.indexOf(least);
      const places = ends(stroke, run, cycle, anatomy);
      layer.capsules = bodies.map(({ radius_mm }, body): Capsule => {
        const isDeepest = least < 0 && body === nearest;
        return {
          from: places[body] as three.Vector3,
          to: places[body + 1] as three.Vector3,
          radius: radius_mm,
          color: isDeepest ? "--alarm" : runColor(number),
          isSeenThrough: isDeepest,
        };
      });
      const at = `${from}/runs/${number}/clearance_mm/${cycle}/${nearest}`;
      const how = (mm: number) => (mm < 0 ? `${millimetres(-mm)} deep` : millimetres(mm));
      if (Number.isFinite(least)) {
        now.replaceChildren(shown(`/bodies/${nearest}/name`), " ", shown(at, how));
      } else now.replaceChildren("clear");
    };
  });
  const cycles = stroke.runs[0]?.places.length ?? 1;
  const time = timeSlider(`${from}/runs/0/places`, cycles, (cycle) => {
    for (const follow of followed) follow(cycle);
    view.outdate();
  });
  return {
    element: make("div", {}, group, time.element),
    go: (run: number) => time.go(stroke.runs[run]?.worst ?? 0),
    dispose() {
      time.stop();
      view.dispose();
    },
  };
}

/** Obliquely down the shaft, from where most of the instrument is seen, at what the tip comes to. */
function outlook(anatomy: Anatomy, stroke: Stroke) {
  const up = new three.Vector3(0, 0, 1);
  const some = stroke.runs.flatMap((run) =>
    [0, 0.2, 0.4, 0.6, 0.8].map((share) =>
      ends(stroke, run, Math.floor(share * run.places.length), anatomy),
    ),
  );
  const [port, wrist] = ends(stroke, stroke.runs[0] as Run, 0, anatomy) as [
    three.Vector3,
    three.Vector3,
  ];
  const axis = port.clone().sub(wrist).normalize();
  const places = some.flatMap((at) => at.slice(1));
  places.push(wrist.clone().addScaledVector(axis, 0.4 * port.distanceTo(wrist)));
  const look = (toward: three.Vector3) => {
    const { middle, height } = fitted(places, toward, up);
    return lookFrom(toward, up, middle, 1.25 * height, anatomy.size);
  };
  const side = new three.Vector3(axis.y, axis.z, axis.x).cross(axis).normalize();
  const directions = Array.from({ length: 12 }, (_, k) =>
    side
      .clone()
      .applyAxisAngle(axis, (Math.PI * k) / 6)
      .addScaledVector(axis, 0.6)
      .normalize(),
  );
  const corners = coarsened(anatomy.positions, anatomy.corners, anatomy.size / 150);
  const trial = [96, 72] as const;
  return look(
    bestDirection(directions, (toward) => {
      const { camera } = look(toward);
      const { depths } = seen(anatomy, corners, camera, trial);
      return places.filter((place) => {
        const { x, y, z } = place.clone().project(camera);
        const [column, row] = [((x + 1) * trial[0]) / 2, ((1 - y) * trial[1]) / 2];
        return z <= (depths[Math.floor(row) * trial[0] + Math.floor(column)] ?? 1);
      }).length;
    }),
  );
}
