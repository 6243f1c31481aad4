// SPDX-License-Identifier: BSD-3-Clause

/** Returns an element with attributes and content. Text is never interpreted as HTML. */
export function make<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  attributes: Readonly<Record<string, string>> = {},
  ...children: readonly (Node | string)[]
): HTMLElementTagNameMap[Tag] {
  return filled(document.createElement(tag), attributes, children);
}

/** Like make(), but returns an SVG element. */
export function drawn<Tag extends keyof SVGElementTagNameMap>(
  tag: Tag,
  attributes: Readonly<Record<string, string>> = {},
  ...children: readonly (Node | string)[]
): SVGElementTagNameMap[Tag] {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  return filled(element, attributes, children);
}

function filled<Made extends Element>(
  element: Made,
  attributes: Readonly<Record<string, string>>,
  children: readonly (Node | string)[],
): Made {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** Returns a count with thousands separators: 24,000. */
export const grouped = (count: number): string => Math.round(count).toLocaleString("en");

/** Returns the text of a number with the sign for minus, which is as wide as a digit; 1e-9 keeps its hyphen. */
export const signed = (number: number | string): string =>
  `${number}`.replace(/^-(?!\S*e)/, "\u2212");

/** Offers a file to the user as a download. */
export function saveFile(name: string, text: string, type: string): void {
  const href = URL.createObjectURL(new Blob([text], { type }));
  make("a", { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), 10_000);
}
