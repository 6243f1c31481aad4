// SPDX-License-Identifier: BSD-3-Clause

/** Returns the current color of a variable of the page's style. */
export function colorOf(variable: string): string {
  const probe = document.body.appendChild(document.createElement("i"));
  probe.style.color = `var(${variable})`;
  const { color } = getComputedStyle(probe);
  probe.remove();
  return color;
}
