// SPDX-License-Identifier: BSD-3-Clause

/** The appearance of an anatomy; colors are in linear light. */
export interface Tissue {
  /** The free side, where light reaches it. */
  readonly base: Color;
  /** The free side in valleys. */
  readonly valley: Color;
  /** The back. */
  readonly hollow: Color;
  /** A section, and its edge. */
  readonly section: Color;
  readonly edge: Color;
  /** The strength of highlights: bone is dull, organs are wet. */
  readonly gloss: number;
  /** True if sharp edges stay sharp. */
  readonly creases: boolean;
}
type Color = readonly [number, number, number];

const bone: Tissue = {
  base: [0.8, 0.69, 0.52],
  valley: [0.5, 0.31, 0.17],
  hollow: [0.34, 0.2, 0.15],
  section: [0.88, 0.62, 0.42],
  edge: [0.2, 0.09, 0.05],
  gloss: 0.06,
  creases: false,
};
const organ = { ...bone, gloss: 0.3 };

export const tissues = {
  bone,
  brain: {
    ...organ,
    base: [0.8, 0.53, 0.47],
    valley: [0.45, 0.11, 0.1],
    section: [0.85, 0.6, 0.53],
  },
  vessel: {
    ...organ,
    // Not as red as the alarm of paths.
    base: [0.58, 0.2, 0.16],
    valley: [0.2, 0.03, 0.025],
    hollow: [0.26, 0.05, 0.05],
    section: [0.82, 0.34, 0.28],
  },
  airway: {
    ...organ,
    base: [0.77, 0.5, 0.44],
    valley: [0.4, 0.13, 0.12],
    section: [0.84, 0.56, 0.5],
  },
  liver: {
    ...organ,
    base: [0.37, 0.095, 0.06],
    valley: [0.14, 0.02, 0.015],
    section: [0.5, 0.18, 0.13],
  },
  /** Generated meshes, and files of the user. */
  shape: {
    ...bone,
    base: [0.72, 0.65, 0.54],
    valley: [0.36, 0.31, 0.26],
    gloss: 0.12,
    creases: true,
  },
} as const satisfies Readonly<Record<string, Tissue>>;

const names: readonly (readonly [RegExp, keyof typeof tissues])[] = [
  [/brain|cerebr/i, "brain"],
  [/aneurysm|vessel|arter|vein|aorta/i, "vessel"],
  [/airway|trachea|bronch/i, "airway"],
  [/liver|hepat/i, "liver"],
  [/skull|femur|bone|vertebra|pelvis|jaw|mandib|tooth|teeth|cranium/i, "bone"],
];

/** Returns the tissue of a mesh by its name. */
export function tissueOf(mesh: string): Tissue {
  const [, name] = names.find(([pattern]) => pattern.test(mesh)) ?? [];
  return tissues[name ?? "shape"];
}
