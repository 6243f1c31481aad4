// SPDX-License-Identifier: BSD-3-Clause

/** The words for the anatomy: "the bone", and for its hollow, "the skull". */
export interface AnatomyWords {
  readonly surface: string;
  readonly hollow: string;
}

/** Returns the words for a mesh with this name. */
export function anatomyWords(mesh: string): AnatomyWords {
  const [, organ] = /(brain|liver|aneurysm|airway)/.exec(mesh) ?? [];
  if (organ !== undefined) return { surface: `the ${organ}`, hollow: `the ${organ}` };
  const [bone] = /skull|femur/.exec(mesh) ?? [];
  if (bone !== undefined) return { surface: "the bone", hollow: `the ${bone}` };
  return { surface: /bone/.test(mesh) ? "the bone" : "it", hollow: "the mesh" };
}
