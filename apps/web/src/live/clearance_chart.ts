// SPDX-License-Identifier: BSD-3-Clause
import uPlot from "uplot";
import { colorOf } from "../page/color_of.ts";
import { signed } from "../page/elements.ts";
import { colors } from "./markers.ts";

/** The length of the visible past. [s] */
const span = 8;

/**
 * Plots the distances of hand and tool from the surface over the last seconds; below 0 is inside.
 */
export class ClearanceChart {
  private readonly plot: uPlot;
  private readonly times: number[] = [];
  private readonly hand: number[] = [];
  private readonly tool: number[] = [];
  private margin = 0;
  private isDue = false;

  constructor(container: HTMLElement) {
    let [ink, line] = ["", ""];
    const read = () => {
      [ink, line] = [colorOf("--soft"), colorOf("--line")];
    };
    read();
    const grid = { stroke: () => line, width: 1 };
    const axis = { stroke: () => ink, grid, ticks: { show: false }, font: "11px system-ui" };
    this.plot = new uPlot(
      {
        width: 300,
        height: 100,
        padding: [8, 14, 0, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: {
          x: { time: false, range: () => [-span, 0] },
          y: { range: (_plot, low, high) => [Math.min(low, -1) - 0.5, Math.max(high, 4) + 0.5] },
        },
        axes: [
          {
            ...axis,
            size: 22,
            values: (_plot, values) => values.map((v) => (v === 0 ? "now" : `${signed(v)} s`)),
          },
          {
            ...axis,
            size: 56,
            space: 24,
            values: (_plot, values) => values.map((v) => `${signed(v)} mm`),
          },
        ],
        series: [
          {},
          { label: "hand", stroke: colors.hand, width: 2, points: { show: false } },
          { label: "tool", stroke: () => colorOf("--tool"), width: 2, points: { show: false } },
        ],
        hooks: { drawClear: [(plot) => this.shadeInside(plot)] },
      },
      [[], [], []],
      container,
    );
    const fit = () => {
      this.plot.setSize({ width: container.clientWidth, height: container.clientHeight });
    };
    new ResizeObserver(fit).observe(container);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      read();
      this.plot.redraw();
    });
  }

  setMargin(margin: number): void {
    this.margin = margin;
    this.plot.redraw();
  }

  clear(): void {
    this.times.length = this.hand.length = this.tool.length = 0;
  }

  /** Adds the clearances [mm] at a time of the page's clock [ms]. */
  add(time: number, hand: number, tool: number): void {
    const seconds = time / 1000;
    this.times.push(seconds);
    this.hand.push(hand);
    this.tool.push(tool);
    while ((this.times[0] as number) < seconds - span) {
      this.times.shift();
      this.hand.shift();
      this.tool.shift();
    }
    if (this.isDue) return;
    this.isDue = true;
    // Limits the figure to fifteen updates a second.
    setTimeout(() => {
      this.isDue = false;
      const now = this.times.at(-1) ?? 0;
      this.plot.setData([this.times.map((t) => t - now), this.hand, this.tool]);
    }, 66);
  }

  /** Shades the inside of the anatomy, and the margin before it. */
  private shadeInside(plot: uPlot): void {
    const { left, width, top, height } = plot.bbox;
    const at = (mm: number) => Math.min(Math.max(plot.valToPos(mm, "y", true), top), top + height);
    const shade = (from: number, to: number, alpha: number) => {
      plot.ctx.globalAlpha = alpha;
      plot.ctx.fillRect(left, at(from), width, at(to) - at(from));
    };
    plot.ctx.save();
    plot.ctx.fillStyle = colors.hand;
    shade(0, -1e9, 0.14);
    plot.ctx.fillStyle = colors.plane;
    shade(this.margin, 0, 0.45);
    plot.ctx.restore();
  }
}
