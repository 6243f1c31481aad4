// SPDX-License-Identifier: BSD-3-Clause

/**
 * Returns the smallest and the largest value. Works for more values than a function call has
 * arguments.
 */
export function extremes(values: Iterable<number>): [number, number] {
  let least = Number.POSITIVE_INFINITY;
  let largest = Number.NEGATIVE_INFINITY;
  for (const value of values) {
    least = Math.min(least, value);
    largest = Math.max(largest, value);
  }
  return [least, largest];
}
