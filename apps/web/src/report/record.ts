// SPDX-License-Identifier: BSD-3-Clause
/** The record that the page shows, see docs/records.md. */
import { unpacked } from "../page/embedded_surface.ts";

/** The common members of all records that the page evaluates. */
export interface ReportRecord {
  readonly keepout_record: string;
  readonly date: string;
  readonly command: string;
  readonly complete: boolean;
  readonly headline: string;
  readonly machine: object | null;
}

/** Percentiles that need more samples than there are, are missing. */
export interface Timing {
  readonly p50: number;
  readonly p99: number | null;
  readonly p999: number | null;
  readonly max: number;
}

let text = "";
let record: unknown;

/** Unpacks the record in the page. Must be called before anything is shown. */
export async function readRecord(): Promise<ReportRecord> {
  const packed = document.getElementById("record")?.textContent;
  if (!packed) throw new Error("this page has no record: keepout puts it there");
  text = new TextDecoder().decode(await unpacked(packed));
  record = JSON.parse(text);
  return record as ReportRecord;
}

/** Returns the record as it was written. */
export const recordText = (): string => text;

/** Returns the pointer to a member in the record, as a JSON pointer (RFC 6901). */
export function below(base: string, ...keys: readonly (string | number)[]): string {
  const escaped = keys.map((key) => String(key).replaceAll("~", "~0").replaceAll("/", "~1"));
  return [base, ...escaped].join("/");
}

/** Returns the last member that a pointer names. */
export const lastKey = (pointer: string): string =>
  pointer
    .slice(pointer.lastIndexOf("/") + 1)
    .replaceAll("~1", "/")
    .replaceAll("~0", "~");

/** Returns the value in the record at a pointer; undefined if it or its parent is missing. */
export function valueAt<T>(pointer: string): T | undefined {
  let value = record as Record<string, unknown> | undefined | null;
  for (const key of pointer.split("/").slice(1)) {
    value = value?.[lastKey(key)] as typeof value;
  }
  return value as T | undefined;
}

/**
 * Returns the pointers to the entries of an array, or to the members of an object, in the record.
 */
export const entries = (pointer: string): string[] =>
  Object.keys(valueAt<object>(pointer) ?? {}).map((key) => below(pointer, key));
