// SPDX-License-Identifier: BSD-3-Clause

/** Returns the bytes that a page contains as base64 of gzip. */
export async function unpacked(base64: string): Promise<ArrayBuffer> {
  const packed = atob(base64);
  const bytes = new Uint8Array(packed.length);
  for (let i = 0; i < packed.length; ++i) bytes[i] = packed.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** The properties of a surface that unpacking needs. */
export interface PackedSurface {
  readonly vertices: number;
  readonly triangles: number;
  readonly coordinates: "float32" | "float64";
}

/**
 * Unpacks a surface that keepout has packed into a page or a record (docs/records.md). The text is
 * base64 of gzip of all x, all y and all z, and of a code for each corner, in four planes of bytes.
 * A corner's code is the first unused vertex number minus its own. All bits of all coordinates are
 * restored.
 */
export async function decodeSurface(
  surface: PackedSurface,
  base64: string,
): Promise<{ vertices: Float64Array; corners: Uint32Array }> {
  const buffer = await unpacked(base64);
  const count = surface.vertices;
  const columns =
    surface.coordinates === "float32"
      ? new Float32Array(buffer, 0, 3 * count)
      : new Float64Array(buffer, 0, 3 * count);
  const vertices = new Float64Array(3 * count);
  for (let i = 0; i < count; ++i) {
    for (let axis = 0; axis < 3; ++axis) {
      vertices[3 * i + axis] = columns[axis * count + i] as number;
    }
  }

  const codes = new Uint8Array(buffer, columns.byteLength);
  const corners = new Uint32Array(3 * surface.triangles);
  let next = 0;
  for (let i = 0; i < corners.length; ++i) {
    let code = 0;
    for (let plane = 3; plane >= 0; --plane) {
      code = 256 * code + (codes[plane * corners.length + i] as number);
    }
    corners[i] = next - code; // modulo 2^32
    if (code === 0) ++next;
  }
  return { vertices, corners };
}
