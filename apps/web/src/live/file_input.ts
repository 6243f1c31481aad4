// SPDX-License-Identifier: BSD-3-Clause
import { element } from "./page.ts";

/** Opens files that the user chooses or drops on the page. */
export function takeFiles(open: (file: File) => void): void {
  const field = element("file", HTMLInputElement);
  element("open", HTMLButtonElement).onclick = () => field.click();
  field.onchange = () => {
    const file = field.files?.[0];
    if (file) open(file);
    field.value = "";
  };
  const dropHint = element("drop", HTMLElement);
  window.addEventListener("dragover", (event) => {
    event.preventDefault();
    dropHint.hidden = false;
  });
  window.addEventListener("dragleave", (event) => {
    if (event.relatedTarget === null) dropHint.hidden = true;
  });
  window.addEventListener("drop", (event) => {
    event.preventDefault();
    dropHint.hidden = true;
    const file = event.dataTransfer?.files[0];
    if (file) open(file);
  });
}
