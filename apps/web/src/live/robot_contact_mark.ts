// SPDX-License-Identifier: BSD-3-Clause
import * as three from "three";
import { sheet } from "./markers.ts";

/** The contact of a body with the surface, in the scene. */
interface Contact {
  readonly core: three.Vector3;
  readonly surface: three.Vector3;
  readonly color: string;
  /** The radius of the drawn plane. [mm] */
  readonly size: number;
}

/** Marks a contact on the anatomy: its point, and the plane there that faces the body. */
export class ContactMark {
  readonly group = new three.Group();
  private readonly plane = sheet("#ffffff");
  private readonly point = new three.Mesh(
    new three.SphereGeometry(1, 16, 12),
    new three.MeshBasicMaterial({ depthTest: false, transparent: true }),
  );
  private readonly materials = [
    this.point.material,
    ...this.plane.children.map((part) => (part as three.Mesh).material as three.MeshBasicMaterial),
  ];

  constructor() {
    this.point.renderOrder = 4;
    this.group.add(this.plane, this.point);
    this.group.visible = false;
  }

  show(contact: Contact | null): void {
    this.group.visible = contact !== null;
    if (contact === null) return;
    const { core, surface, size } = contact;
    const normal = core.clone().sub(surface);
    this.plane.visible = normal.lengthSq() > 1e-12;
    this.plane.position.copy(surface);
    this.plane.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), normal.normalize());
    this.plane.scale.setScalar(size);
    this.point.position.copy(surface);
    this.point.scale.setScalar(0.1 * size);
    for (const material of this.materials) material.color.set(contact.color);
  }
}
