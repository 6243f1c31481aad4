// SPDX-License-Identifier: BSD-3-Clause

import * as three from "three";
import { type Anatomy, fitted, lookFrom, type Outlook, outward } from "./anatomy.ts";
import { extremes } from "./extremes.ts";
import {
  type Moment,
  type SimulationRecord,
  type Stroke,
  trespass,
  worstCycle,
} from "./simulation_record.ts";

/**
 * A cut along a path: a curtain that hangs from the path; the anatomy in front of it is removed. It
 * is fixed to the anatomy, so that the view can be turned. It stores a depth towards the viewer for
 * each sideways position.
 */
export interface Cut {
  readonly sideways: three.Vector3;
  readonly toward: three.Vector3;
  /** The sideways positions of the first and the last depth. [mm] */
  readonly from: number;
  readonly to: number;
  readonly depths: Float32Array;
}

/** The frame of a close-up. */
interface CloseUp extends Outlook {
  readonly sideways: three.Vector3;
  readonly toward: three.Vector3;
  readonly height: number;
}

const columns = 1024;
/** Depths are averaged over this many columns to either side, which removes steps. */
const smoothing = 6;

/**
 * Hangs a curtain from a path, in both directions from its start. The first of overlapping parts
 * counts.
 */
export function hang(path: readonly three.Vector3[], start: number, frame: CloseUp): Cut {
  const { sideways, toward } = frame;
  const across = path.map((place) => place.dot(sideways));
  const [from, end] = extremes(across);
  const to = Math.max(end, from + 1e-6);
  const depths = new Float32Array(columns).fill(Number.NaN);
  const column = (i: number) => (((across[i] as number) - from) / (to - from)) * (columns - 1);
  const depth = (i: number) => path[i]?.dot(toward) as number;
  const span = (a: number, b: number) => {
    if (a < 0 || b < 0 || a >= path.length || b >= path.length) return;
    const way = column(b) - column(a);
    const [low, high] = [Math.min(column(a), column(b)), Math.max(column(a), column(b))];
    for (let x = Math.floor(low); x <= high; ++x) {
      if (!Number.isNaN(depths[x])) continue;
      const share = Math.abs(way) < 1 ? 0 : Math.min(Math.max((x - column(a)) / way, 0), 1);
      depths[x] = depth(a) + share * (depth(b) - depth(a));
    }
  };
  span(start, start);
  for (let k = 1; k < path.length; ++k) {
    span(start - k + 1, start - k);
    span(start + k - 1, start + k);
  }
  const smooth = depths.map((_, x) => {
    const near = depths.subarray(Math.max(0, x - smoothing), x + smoothing + 1);
    const known = near.filter((one) => !Number.isNaN(one));
    return known.reduce((sum, one) => sum + one, 0) / known.length;
  });
  return { sideways, toward, from, to, depths: smooth };
}

/** Returns the distances of places behind a curtain, three coordinates each. [mm] */
export function restBehind(
  { sideways, toward, from, to, depths }: Cut,
  places: Float32Array,
): Float32Array {
  const place = new three.Vector3();
  return new Float32Array(places.length / 3).map((_, i) => {
    place.fromArray(places, 3 * i);
    const share = Math.min(Math.max((place.dot(sideways) - from) / (to - from), 0), 1);
    return (depths[Math.round(share * (columns - 1))] as number) - place.dot(toward);
  });
}

/**
 * Views a moment from the side of its stroke: all of the stroke or, if that hides it, the depth.
 */
export function closeUp(record: SimulationRecord, moment: Moment, anatomy: Anatomy): CloseUp {
  const tips = record.runs.flatMap((run) =>
    (run.strokes[moment.stroke] as Stroke).tip.map(anatomy.placed),
  );
  const least = 0.02 * anatomy.size;
  const extent = new three.Box3().setFromPoints(tips).getSize(new three.Vector3()).length();
  const wide = lookAt(record, moment, anatomy, Math.max(extent, least));
  const fit = fitted(tips, wide.eye, wide.out);
  const height = Math.max(1.28 * fit.height, least);
  const depths = record.runs.map(
    (run) => -Math.min(0, ...(run.strokes[moment.stroke] as Stroke).clearance_mm),
  );
  const told = depths[moment.run] as number;
  if (told === 0 || told >= 0.03 * height) {
    // Space for labels, and for the scale bar below.
    fit.middle.addScaledVector(wide.out, -0.06 * height);
    return { ...wide, ...lookFrom(wide.eye, wide.out, fit.middle, height, anatomy.size), height };
  }
  const near = Math.max(
    Math.min(Math.max(2.5 * Math.max(...depths), 5 * told), 14 * told),
    1e-3 * anatomy.size,
  );
  return lookAt(record, moment, anatomy, near);
}

function lookAt(record: SimulationRecord, moment: Moment, anatomy: Anatomy, height: number) {
  const run = record.runs[moment.run] as SimulationRecord["runs"][number];
  const stroke = run.strokes[moment.stroke] as Stroke;
  const path = stroke.tip.map(anatomy.placed);
  const place = path[moment.cycle] as three.Vector3;
  const bad = trespass(run, moment.stroke, record);
  const entry = path[Math.max(bad.lastIndexOf(false, moment.cycle), 0)] as three.Vector3;
  const hand = anatomy.placed(record.hand[moment.stroke]?.[0] ?? [0, 0, 0]);
  const widest = 4; // [mm]; excludes the far side of a thin branch
  const out =
    outward(anatomy, entry, Math.min(0.3 * height, widest) + entry.distanceTo(place)) ??
    hand.sub(place).normalize();

  // Sideways to the motion of the tip, so that the picture shows its length.
  const way = new three.Vector3();
  for (const tip of path) {
    const offset = tip.clone().sub(place);
    if (offset.length() > height) continue;
    offset.addScaledVector(out, -out.dot(offset));
    way.addScaledVector(offset, way.dot(offset) < 0 ? -1 : 1);
  }
  if (way.lengthSq() === 0) way.set(out.y, out.z, out.x).cross(out);
  const toward = way.cross(out).normalize();
  if (toward.dot(new three.Vector3(...record.up)) < 0) toward.negate();

  // From slightly above, the surface appears as the ground and the cut as its front. The surface is
  // above the middle, because most of the relevant parts are at it or below.
  const eye = toward.clone().addScaledVector(out, 0.35);
  const depth = Math.max(0, -(stroke.clearance_mm[moment.cycle] as number));
  const target = place.clone().addScaledVector(out, depth - 0.12 * height);
  const sideways = out.clone().cross(toward);
  return {
    ...lookFrom(eye, out, target, height, anatomy.size),
    eye,
    out,
    sideways,
    toward,
    height,
  };
}

/**
 * Returns the cycle that a close-up marks: the deepest penetration, or else the nearest visible
 * one.
 */
export function markedCycle(
  record: SimulationRecord,
  number: number,
  moment: Moment,
  { camera }: Outlook,
  { placed }: Anatomy,
): number {
  if (number === moment.run) return moment.cycle;
  const run = record.runs[number] as SimulationRecord["runs"][number];
  const worst = worstCycle(run, moment.stroke);
  if (trespass(run, moment.stroke, record)[worst]) return worst;
  const { tip, clearance_mm } = run.strokes[moment.stroke] as Stroke;
  const seen = tip.map((place) => {
    const { x, y } = placed(place).project(camera);
    return Math.max(Math.abs(x), Math.abs(y)) <= 1;
  });
  const nearest = extremes(clearance_mm.filter((_, i) => seen[i]))[0];
  const cycle = clearance_mm.findIndex((clearance, i) => seen[i] && clearance === nearest);
  return cycle < 0 ? worst : cycle;
}
