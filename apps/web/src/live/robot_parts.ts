// SPDX-License-Identifier: BSD-3-Clause
/**
 * The drawn parts of a da Vinci instrument. All guarded parts lie within the capsules that keepout
 * guards: tests/web/robot_test.mjs compares them. Lengths are in mm.
 *
 * Each group has its own frame, whose y axis points to the tip. The x axis of shaft and wrist is
 * along the wrist's pitch axis, and that of a jaw points away from the other jaw. The z axis of
 * wrist and jaws is along the yaw axis.
 */
import * as three from "three";

/** The length of the shaft of an 8 mm instrument, from its housing to the wrist: robots.cpp. */
export const shaftLength = 416.2;
/** The length of a jaw, and of the wrist between its axes: robots.cpp. */
const [jawLength, wristLength] = [10.2, 9.1];
/** The radius of the drawn shaft; its guarded capsule has 4.5. */
const shaftRadius = 4;
/** The distances from the pitch axis at which the shaft ends in a collar, and the collar in the clevis. */
const [collar, clevis] = [10, 7];

const metal = (color: string, shininess = 40) =>
  new three.MeshPhongMaterial({ color, shininess, specular: "#5a6068", side: three.DoubleSide });
const steel = metal("#a9b4c2");
const dark = metal("#3d444e", 15);
const bright = metal("#d6dce4", 70);

const unit = new three.CylinderGeometry(1, 1, 1, 32);
const cube = new three.BoxGeometry(1, 1, 1);

/** Returns a cylinder from one place to another. */
function rod(
  radius: number,
  from: three.Vector3Tuple,
  to: three.Vector3Tuple,
  of: three.Material = steel,
) {
  const made = new three.Mesh(unit, of);
  const [begin, end] = [new three.Vector3(...from), new three.Vector3(...to)];
  const way = end.clone().sub(begin);
  made.position.lerpVectors(begin, end, 0.5);
  made.scale.set(radius, way.length(), radius);
  made.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), way.normalize());
  return made;
}

/** Returns a box with these sides about a place. */
function block(sides: three.Vector3Tuple, at: three.Vector3Tuple, of: three.Material = steel) {
  const made = new three.Mesh(cube, of);
  made.scale.set(...sides);
  made.position.set(...at);
  return made;
}

/** Returns an ear: a plate across x from y = `from` to `to`, where it is round about an axis. */
function ear(
  x: number,
  thickness: number,
  from: number,
  to: number,
  radius: number,
  of: three.Material = steel,
) {
  const round = rod(radius, [x - thickness / 2, to, 0], [x + thickness / 2, to, 0], of);
  return [round, block([thickness, Math.abs(to - from), 2 * radius], [x, (from + to) / 2, 0], of)];
}

/** The shaft within the body, as long as it is deep, and the clevis of the pitch axis. */
function makeShaft(): { group: three.Group; tube: three.Mesh } {
  const tube = rod(shaftRadius, [0, -1, 0], [0, 0, 0], dark);
  const group = new three.Group().add(
    tube,
    rod(shaftRadius, [0, -collar, 0], [0, -clevis, 0]),
    ...[-2.8, 2.8].flatMap((x) => ear(x, 1.4, -clevis, 0, 2.4)),
    rod(0.9, [-3.7, 0, 0], [3.7, 0, 0], bright),
  );
  return { group, tube };
}

/** The link between both axes of the wrist: a tongue, and a clevis for the jaws. */
function makeWrist(): three.Group {
  const fork = new three.Group().add(...[-1.85, 1.85].flatMap((x) => ear(x, 0.8, -4, 0, 1.7)));
  fork.position.y = wristLength;
  fork.rotation.y = Math.PI / 2;
  return new three.Group().add(
    ...ear(0, 3.4, 4.6, 0, 2.2),
    block([3.4, 2.2, 4.3], [0, 4.6, 0]),
    fork,
    rod(0.7, [0, wristLength, -2.5], [0, wristLength, 2.5], bright),
  );
}

/** The outline of half a jaw: distances from its axis, along it. */
const outline = [
  [0.95, 0],
  [0.95, 4.5],
  [0.82, 8],
  [0.62, jawLength],
  [0.35, jawLength + 0.55],
  [0, jawLength + 0.75],
].map(([radius, along]) => new three.Vector2(radius, along));

/** A jaw: half a rod with ridges on its flat side, and its hub on one half of the yaw axis. */
function makeJaw(of: three.Material): three.Group {
  const back = new three.Mesh(new three.LatheGeometry(outline, 16, 0, Math.PI), of);
  const face = new three.Mesh(flatSide(), dark);
  const hub = rod(1.6, [0, 0, 0.1], [0, 0, 1.25]);
  return new three.Group().add(back, face, hub);
}

/** The flat side of a jaw, in the plane x = 0, with ridges. */
function flatSide(): three.BufferGeometry {
  const ridges = 24;
  const places: number[] = [];
  const width = (along: number) => {
    const after = outline.findIndex(({ y }) => y >= along);
    const [a, b] = [outline[Math.max(after - 1, 0)], outline[Math.max(after, 0)]];
    if (a === undefined || b === undefined || a === b) return outline[0]?.x ?? 0;
    return a.x + ((along - a.y) / (b.y - a.y)) * (b.x - a.x);
  };
  const corners = Array.from({ length: ridges + 1 }, (_, i) => {
    const along = (i / ridges) * (jawLength + 0.7);
    return { along, wide: width(along), high: i % 2 === 0 ? 0 : 0.12 };
  });
  corners.slice(1).forEach((b, i) => {
    const a = corners[i] as typeof b;
    const quad = [
      [a.high, a.along, -a.wide],
      [a.high, a.along, a.wide],
      [b.high, b.along, b.wide],
      [b.high, b.along, -b.wide],
    ];
    for (const corner of [0, 1, 2, 0, 2, 3]) places.push(...(quad[corner] as number[]));
  });
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.Float32BufferAttribute(places, 3));
  geometry.computeVertexNormals();
  return geometry;
}

/** A patch of skin around the port, which fades at its rim; y points outwards. */
function makeSkin(): three.Group {
  const [rings, sectors, hole, edge] = [8, 48, 5.2, 34];
  const places: number[] = [];
  const tints: number[] = [];
  const order: number[] = [];
  for (let ring = 0; ring <= rings; ++ring) {
    const share = ring / rings;
    const radius = hole + share * (edge - hole);
    for (let sector = 0; sector < sectors; ++sector) {
      const angle = (2 * Math.PI * sector) / sectors;
      // It rises to the rim of the hole, and bends down to its edge.
      const height = 1.2 * Math.exp(-(((radius - hole) / 4) ** 2)) - 0.004 * radius ** 2;
      places.push(radius * Math.cos(angle), height, radius * Math.sin(angle));
      const shade = ring === 0 ? 0.62 : 1;
      tints.push(0.87 * shade, 0.63 * shade, 0.52 * shade, 0.92 * (1 - share ** 3));
      if (ring === rings) continue;
      const next = (sector + 1) % sectors;
      const [a, b] = [ring * sectors + sector, ring * sectors + next];
      order.push(a, b, a + sectors, b, b + sectors, a + sectors);
    }
  }
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.Float32BufferAttribute(places, 3));
  geometry.setAttribute("color", new three.Float32BufferAttribute(tints, 4));
  geometry.setIndex(order);
  geometry.computeVertexNormals();
  const material = new three.MeshLambertMaterial({
    vertexColors: true,
    emissive: "#5e3b2e",
    transparent: true,
    depthWrite: false,
    side: three.DoubleSide,
  });
  return new three.Group().add(new three.Mesh(geometry, material));
}

const ghost = new three.MeshLambertMaterial({
  color: "#8f9aa9",
  transparent: true,
  opacity: 0.5,
  side: three.DoubleSide,
});

/** The profile of the cannula above the port: a tube with a bowl. */
const bowl = [
  [5, 0.3],
  [5.6, 0.3],
  [5.6, 52],
  [9.5, 62],
  [11, 76],
  [9.8, 76],
  [8.5, 63],
  [4.8, 53],
].map(([radius, along]) => new three.Vector2(radius, along));

/** The parts above the port: the cannula, the rest of the shaft, and a hint of the arm. y points outwards. */
function makeOutside() {
  const tube = new three.Mesh(unit, dark);
  const housing = new three.Group().add(
    block([46, 26, 34], [2, 13, 0], ghost),
    block([30, 60, 40], [20, 45, 0], ghost),
  );
  const group = new three.Group().add(
    tube,
    new three.Mesh(new three.LatheGeometry(bowl, 32), steel),
    // The marks of the remote center.
    ...[3, 6, 20].map((y) => rod(5.75, [0, y, 0], [0, y + 1.2, 0], dark)),
    block([34, 11, 12], [24, 66, 0], ghost),
    block([13, 400, 26], [46, 255, 0], ghost),
    housing,
  );
  return { group, tube, housing };
}

/** A pose of the instrument in the scene. */
export interface InstrumentPose {
  readonly port: three.Vector3;
  /** Points on the pitch axis and on the yaw axis, in the middle of the instrument. */
  readonly pitch: three.Vector3;
  readonly yaw: three.Vector3;
  /** The ends of one or two jaws; one if they are closed. */
  readonly ends: readonly three.Vector3[];
  /** The direction of the yaw axis. */
  readonly axis: three.Vector3;
}

/** The whole instrument with its surroundings. */
export class InstrumentParts {
  private readonly shaft = makeShaft();
  private readonly wrist = makeWrist();
  private readonly outside = makeOutside();
  private readonly skin = makeSkin();
  private readonly jawMetal = metal("#ffffff", 0.35);
  private readonly jaws = [0, 1].map(() => makeJaw(this.jawMetal));
  /** Guarded by keepout, in the order of its bodies, with two jaws. */
  readonly guarded: readonly three.Group[] = [this.shaft.group, this.wrist, ...this.jaws];
  /** Not guarded: all of it is outside of the port. */
  readonly unguarded: readonly three.Group[] = [this.outside.group, this.skin];

  /** Gives the jaws the color of a rule. */
  paint(color: string): void {
    this.jawMetal.color.set(color);
  }

  /** Lays the skin about a port; `outwards`: a unit vector. */
  layPort(port: three.Vector3, outwards: three.Vector3): void {
    this.skin.position.copy(port);
    this.skin.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), outwards);
  }

  place({ port, pitch, yaw, ends, axis }: InstrumentPose): void {
    const down = pitch.clone().sub(port);
    const depth = down.length();
    down.normalize();
    const along = yaw.clone().sub(pitch).normalize();
    const pitchAxis = along.clone().cross(axis).normalize();
    put(this.shaft.group, pitch, pitchAxis, down);
    const length = Math.max(depth - collar, 0);
    this.shaft.tube.scale.y = length;
    this.shaft.tube.position.y = -collar - length / 2;
    put(this.wrist, pitch, pitchAxis, along);
    this.jaws.forEach((jaw, i) => {
      const way = (ends[i] ?? (ends[0] as three.Vector3)).clone().sub(yaw).normalize();
      // The first jaw turns away from x, the second one towards it.
      put(jaw, yaw, way.clone().cross(axis).normalize(), way);
      if (i === 0) jaw.rotateY(Math.PI);
    });

    const up = down.clone().negate();
    const sky = new three.Vector3(0, 0, 1);
    const side = sky.addScaledVector(up, -sky.dot(up));
    if (side.lengthSq() < 1e-4) side.set(1, 0, 0).addScaledVector(up, -up.x);
    put(this.outside.group, port, side.normalize(), up);
    const above = Math.max(shaftLength - depth, 1);
    this.outside.tube.scale.set(shaftRadius, above, shaftRadius);
    this.outside.tube.position.y = above / 2;
    this.outside.housing.position.y = above;
  }
}

/** Sets the frame of a group, from two of its axes. */
function put(group: three.Group, at: three.Vector3, x: three.Vector3, y: three.Vector3): void {
  const across = x.clone().addScaledVector(y, -x.dot(y)).normalize();
  const axes = new three.Matrix4().makeBasis(across, y, across.clone().cross(y));
  group.quaternion.setFromRotationMatrix(axes);
  group.position.copy(at);
}
