// SPDX-License-Identifier: BSD-3-Clause
/** The record that the page shows: docs/records.md says what is in it. */
import { unpacked } from "../page/embedded_surface.ts";

/** What all records have, as far as the page does not only show it. */
export interface ReportRecord {
  readonly keepout_record: string;
  readonly date: string;
  readonly command: string;
  readonly complete: boolean;
  readonly headline: string;
  readonly machine: object | null;
}

/** Times of which some need more samples than there are. */
export interface Timing {
  readonly p50: number;
  readonly p99: number | null;
  readonly p999: number | null;
  readonly max: number;
}

let text = "";
let record: unknown;

/** Unpacks what `keepout` has put into the page. To be called before anything is shown. */
export async function readRecord(): Promise<ReportRecord> {
  const packed = document.getElementById("record")?.textContent;
  if (!packed) throw new Error("this page has no record: keepout puts it there");
  text = new TextDecoder().decode(await unpacked(packed));
  record = JSON.parse(text);
  return record as ReportRecord;
}

/** The record as it was written. */
export const recordText = (): string => text;

/** The place of a member in the record, as a JSON pointer (RFC 6901). */
export function below(base: string, ...keys: readonly (string | number)[]): string {
  const escaped = keys.map((key) => String(key).replaceAll("~", "~0").replaceAll("/", "~1"));
  return [base, ...escaped].join("/");
}

/** The last member that a pointer names. */
export const lastKey = (pointer: string): string =>
  pointer
    .slice(pointer.lastIndexOf("/") + 1)
    .replaceAll("~1", "/")
    .replaceAll("~0", "~");

/** What is in the record at a pointer; undefined where there is nothing, or nothing above it. */
export function valueAt<T>(pointer: string): T | undefined {
  let value = record as Record<string, unknown> | undefined | null;
  for (const key of pointer.split("/").slice(1)) {
    value = value?.[lastKey(key)] as typeof value;
  }
  return value as T | undefined;
}

/** Where the entries of an array, or the members of an object, are in the record. */
export const entries = (pointer: string): string[] =>
  Object.keys(valueAt<object>(pointer) ?? {}).map((key) => below(pointer, key));
