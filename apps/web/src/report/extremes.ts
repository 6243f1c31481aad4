// SPDX-License-Identifier: BSD-3-Clause

/** The least and the largest of values, of which there may be more than a call takes arguments. */
export function extremes(values: Iterable<number>): [number, number] {
  let least = Number.POSITIVE_INFINITY;
  let largest = Number.NEGATIVE_INFINITY;
  for (const value of values) {
    least = Math.min(least, value);
    largest = Math.max(largest, value);
  }
  return [least, largest];
}
