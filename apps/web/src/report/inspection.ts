// SPDX-License-Identifier: BSD-3-Clause
/** The sections of an inspection, which shows a mesh with its faults marked: docs/records.md. */
import * as three from "three";
import { drawn, grouped, make } from "../page/elements.ts";
import { type Anatomy, lookAtAll, unpackedAnatomy, verticesOf } from "./anatomy.ts";
import { AnatomyView, hint } from "./anatomy_view.ts";
import { type Mark, mark } from "./marks.ts";
import type { Layer } from "./painting.ts";
import { widths } from "./paths.ts";
import { below, type ReportRecord, valueAt } from "./record.ts";
import { lead, panels, section } from "./report_page.ts";
import { ordinal, pictureGrid } from "./runs.ts";
import { type Format, paragraphs, show, shown } from "./shown.ts";
import type { Place, RecordedMesh } from "./simulation_record.ts";
import { type Column, column, scrolled, table } from "./table.ts";

interface FaultPlace {
  readonly at: Place;
  readonly corners: readonly Place[];
}
interface Finding {
  readonly key: string;
  readonly groups: number;
  readonly places: readonly FaultPlace[];
}
interface InspectionRecord extends ReportRecord {
  readonly mesh: RecordedMesh;
  readonly inspection: { readonly findings: readonly Finding[] };
}

/** The most groups of faults with rings, and the most faults with rows, of each kind. */
const [mostRings, mostRows] = [10, 100];

/** Shows the page of `inspect`. */
export async function inspectionSections(main: HTMLElement, record: ReportRecord): Promise<void> {
  const { mesh, inspection } = record as InspectionRecord;
  const anatomy = await unpackedAnatomy(mesh);
  const findings = inspection.findings.map((finding, number) => ({
    ...finding,
    from: below("/inspection/findings", number),
  }));
  const coordinate = coordinates(anatomy);
  const marked = findings.filter(({ places }) => places.length > 0);
  main.append(
    ...paragraphs("/inspection/notices", "account"),
    ...paragraphs("/inspection/warnings", "account"),
    ...findings.filter(({ places }) => places.length === 0).map(unmarked),
    pictures(anatomy, marked),
    ...(marked.length > 0 ? [faultTable(marked, coordinate)] : []),
    facts(coordinate),
  );
}

type Located = Finding & { readonly from: string };

/** Returns the meaning of a finding, and the advice. */
const advice = (from: string) => [
  make("b", {}, "Meaning:"),
  " ",
  shown(`${from}/meaning`),
  ". ",
  make("b", {}, "What to do:"),
  " ",
  shown(`${from}/advice`),
  ".",
];

/** Returns a finding about the whole mesh. */
const unmarked = ({ from }: Located) => make("p", { class: "account bad" }, ...advice(from));

/** Returns the mesh, once for each kind of fault. */
function pictures(anatomy: Anatomy, findings: readonly Located[]): HTMLElement {
  const group = pictureGrid(findings.length);
  const up = new three.Vector3(0, 0, 1);
  const outlook = lookAtAll(verticesOf(anatomy), direction(anatomy, findings), up, anatomy);
  const view = new AnatomyView(group, anatomy, anatomy.corners, outlook);
  if (findings.length === 0) {
    view.add("The mesh.", { lengths: [], cut: null }, [], shown("/mesh/name"));
  }
  for (const finding of findings) {
    const name = finding.key.replaceAll("_", " ");
    view.add(
      `The mesh with its ${name} in the color of alarm.`,
      layerOf(anatomy, finding),
      rings(anatomy, finding),
      make("span", { class: "badge bad" }, shown(`${finding.from}/count`, grouped)),
      make("span", { class: "name" }, name),
      make("br"),
      make("span", { class: "about" }, ...advice(finding.from)),
    );
  }
  const words = [
    make("b", {}, "Red"),
    ": faults, also where the surface hides them; at most ",
    shown("/inspection/most_places", grouped),
    " of each kind. Faults that share vertices are one group. Rings are around one fault of each of the first groups, by their numbers in the table. Dark: the back of triangles.",
  ];
  return findings.length > 0
    ? section("Where the faults are", lead(...words), group, hint(findings.length))
    : section("The mesh", group, hint(1));
}

/** Returns a direction that shows the first fault, slightly from above and from the side. */
function direction({ placed }: Anatomy, findings: readonly Located[]): three.Vector3 {
  const oblique = new three.Vector3(0.45, -0.25, 0.175);
  const [first] = findings.flatMap(({ places }) => places);
  return first ? placed(first.at).normalize().add(oblique) : oblique;
}

/** Returns the outlines of faults: a vertex as a dot, an edge, a triangle, or two triangles. */
function layerOf({ placed }: Anatomy, { places }: Finding): Layer {
  const ends = places.flatMap(({ corners }) =>
    corners.flatMap((corner, i) => {
      const first = i - (i % 3);
      const size = Math.min(corners.length - first, 3);
      if (size === 2 && i > first) return []; // an edge once
      const next = corners[first + ((i - first + 1) % size)] as Place;
      return [...placed(corner).toArray(), ...placed(next).toArray()];
    }),
  );
  return {
    lengths: [
      {
        ends: new Float32Array(ends),
        color: "--alarm",
        isAlarming: true,
        isSeenThrough: true,
        width: widths.near,
      },
    ],
    cut: null,
  };
}

/** Returns rings with numbers, which make small faults visible. */
const rings = ({ placed }: Anatomy, { from, groups, places }: Located): Mark[] =>
  places.slice(0, Math.min(groups, mostRings)).map(({ at }, number) => {
    const pointer = below(from, "places", number);
    const label = drawn("tspan", { "data-from": pointer, "data-ordinal": "" }, String(number + 1));
    return mark("ring numbered bad", placed(at), 13, label);
  });

/** Formats coordinates in mm with as many decimals as the size of the mesh has with six digits. */
function coordinates({ size }: Anatomy): Format {
  const decimals = Math.min(Math.max(5 - Math.floor(Math.log10(size)), 0), 12);
  return (mm) => mm.toFixed(decimals).replace(/^-(?=[0.]*$)/, "");
}

/** Returns the first faults of each kind and their places. */
function faultTable(findings: readonly Located[], coordinate: Format): HTMLElement {
  const keyOf = (row: string) => row.replace(/\/places\/\d+$/, "/key");
  const columns: readonly Column[] = [
    { heading: "fault", from: "", look: "name", content: (row) => [shown(keyOf(row))] },
    { heading: "number", from: "", content: (row) => [ordinal(row)] },
    column("x [mm]", "/at/0", coordinate),
    column("y [mm]", "/at/1", coordinate),
    column("z [mm]", "/at/2", coordinate),
  ];
  const rows = findings.flatMap(({ from, places }) =>
    places.slice(0, mostRows).map((_, number) => below(from, "places", number)),
  );
  return section(
    "Coordinates",
    lead("The middle of an edge or a triangle, or a point where two triangles meet."),
    scrolled(table(rows, columns), "scroll windowed"),
  );
}

/** Returns the facts of the mesh. */
function facts(coordinate: Format): HTMLElement {
  const about = "/inspection";
  const names: readonly (readonly [string, string, Format?])[] = [
    ["triangles", "triangles", grouped],
    ["vertices", "vertices", grouped],
    ["edges", "edges", grouped],
    ["components", "components", grouped],
    ["watertight", "watertight"],
    ["handles", "genus", grouped],
    ["area [mm²]", "area"],
    ["volume [mm³]", "signed_volume"],
    ["space", "space"],
  ];
  const list = names
    .filter(([, key]) => valueAt(`${about}/${key}`) !== null)
    .flatMap(([name, key, format]) => [
      make("dt", {}, name),
      show(make("dd"), `${about}/${key}`, format),
    ]);
  const corners = (["low", "high"] as const).flatMap((end) => [
    make("dt", {}, end === "low" ? "from [mm]" : "to [mm]"),
    make(
      "dd",
      {},
      ...[0, 1, 2].flatMap((axis) => [
        ...(axis > 0 ? [", "] : []),
        shown(`${about}/bounds/${end}/${axis}`, coordinate),
      ]),
    ),
  ]);
  return section(
    "What the mesh is made of",
    panels(make("figure", {}, make("dl", {}, ...list, ...corners))),
  );
}
