// SPDX-License-Identifier: BSD-3-Clause

/** How a picture is drawn, from the finest to the lightest. */
export interface Quality {
  readonly name: "full" | "light" | "lightest";
  /** Drawn pixels per pixel of the screen, along a side. */
  readonly scale: number;
  /** Per pixel, for smooth edges. */
  readonly samples: number;
  /** True for shadow and clearance of the tool on the surface. */
  readonly shade: boolean;
}

export const qualities: readonly [Quality, Quality, Quality] = [
  { name: "full", scale: 1, samples: 4, shade: true },
  { name: "light", scale: 0.6, samples: 0, shade: true },
  { name: "lightest", scale: 0.6, samples: 0, shade: false },
];

/** The number of frames that are judged together. */
const together = 24;
/** Longer frames are slow, and shorter ones leave time for a finer picture. [ms] */
const [slow, quick] = [26, 18];
/** The time between two frames that are not one after the other. [ms] */
const pause = 1000;
/** The time for which frames must be quick before a finer picture is tried. [ms] */
const firstPatience = 10_000;

/**
 * Chooses the quality of a picture by the measured time of its frames, and not by the names of
 * browser or processor. If a finer picture turned out to be too slow, waits longer before the next
 * trial.
 */
export class PictureQuality {
  private level: number;
  private readonly frames: number[] = [];
  /** The time for which frames have been quick. [ms] */
  private quickFor = 0;
  private patience = firstPatience;
  private isTrial = false;

  /** `finest`: the number of the first quality, and of the finest one that is tried. */
  constructor(private readonly finest: number) {
    this.level = finest;
  }

  get quality(): Quality {
    return qualities[this.level] as Quality;
  }

  /** Adds the time from a frame to the next one. Returns true if the quality changed. [ms] */
  add(time: number): boolean {
    if (time > pause) return false;
    this.frames.push(time);
    if (this.frames.length < together) return false;
    const frames = this.frames.splice(0).sort((a, b) => a - b);
    const usual = frames[together / 2] as number;
    if (usual > slow && this.level < qualities.length - 1) {
      if (this.isTrial) this.patience *= 2;
      return this.change(this.level + 1, false);
    }
    this.isTrial = false;
    this.quickFor = usual < quick ? this.quickFor + together * usual : 0;
    if (this.level <= this.finest || this.quickFor < this.patience) return false;
    return this.change(this.level - 1, true);
  }

  private change(level: number, isTrial: boolean): boolean {
    this.level = level;
    this.isTrial = isTrial;
    this.quickFor = 0;
    return true;
  }
}
