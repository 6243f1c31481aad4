// SPDX-License-Identifier: BSD-3-Clause
/** SVG pictures of a record: they are displayed, but cannot execute anything. */

const elements = new Set(
  "svg g defs clipPath path rect circle ellipse line polyline polygon text tspan use title desc style".split(
    " ",
  ),
);

/** True if an attribute or a style refers only to the picture itself. */
const isOwn = (text: string): boolean =>
  !/@import|\\|image-set|src\(/i.test(text) && !/url\((?!\s*['"]?#)/i.test(text);

/** Removes everything except shapes, texts and their styles: no script, no other file. */
function strip(element: Element): void {
  for (const { name, localName, value } of [...element.attributes]) {
    const leads = localName === "href" && !value.startsWith("#");
    if (leads || /^on/i.test(localName) || !isOwn(value)) element.removeAttribute(name);
  }
  for (const child of [...element.children]) {
    const isKnown = child.namespaceURI === element.namespaceURI && elements.has(child.localName);
    if (!isKnown || (child.localName === "style" && !isOwn(child.textContent))) child.remove();
    else strip(child);
  }
}

/**
 * Returns the picture of this SVG in its own shadow root, so that its names and styles do not mix
 * with the page's. Shows a message if the text is not SVG.
 */
export function drawnSvg(text: string, name: string): HTMLElement {
  const host = document.createElement("div");
  const picture = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
  if (picture.namespaceURI !== "http://www.w3.org/2000/svg" || picture.localName !== "svg") {
    host.textContent = "This picture is no SVG that can be read.";
    return host;
  }
  strip(picture);
  picture.setAttribute("role", "img");
  picture.setAttribute("aria-label", name);
  for (const side of ["width", "height"]) picture.removeAttribute(side);
  picture.setAttribute("style", "display:block;width:100%;height:auto");
  host.attachShadow({ mode: "open" }).append(document.importNode(picture, true));
  return host;
}
