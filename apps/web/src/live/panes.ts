// SPDX-License-Identifier: BSD-3-Clause

/** A part of the view, from its upper left corner. [px] */
export interface Area {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/** The one or two equal parts of a view: beside each other, or above each other in a high view. */
export class Panes {
  count: 1 | 2 = 1;

  constructor(private readonly container: HTMLElement) {}

  areas(): Area[] {
    const { clientWidth, clientHeight } = this.container;
    const isHigh = clientHeight > clientWidth;
    const width = this.count === 2 && !isHigh ? Math.floor(clientWidth / 2) : clientWidth;
    const height = this.count === 2 && isHigh ? Math.floor(clientHeight / 2) : clientHeight;
    return Array.from({ length: this.count }, (_, i) => ({
      x: isHigh ? 0 : i * width,
      y: isHigh ? i * height : 0,
      width,
      height,
    }));
  }

  /** Returns one of them; all have this size. */
  area(pane = 0): Area {
    return this.areas()[pane] as Area;
  }

  /** Returns the number of the pane under a pointer. */
  under(event: MouseEvent): number {
    const { left, top } = this.container.getBoundingClientRect();
    const { width, height } = this.area();
    const isFirst = event.clientX - left < width && event.clientY - top < height;
    return isFirst || this.count === 1 ? 0 : 1;
  }

  /** Returns a position in a pane, from -1 to 1 in both directions. */
  within(event: MouseEvent, pane: number): { x: number; y: number } {
    const { left, top } = this.container.getBoundingClientRect();
    const { x, y, width, height } = this.area(pane);
    return {
      x: (2 * (event.clientX - left - x)) / width - 1,
      y: 1 - (2 * (event.clientY - top - y)) / height,
    };
  }
}
