/** How much is drawn. */
export interface Quality {
  readonly pixelRatio: number; // of the screen's own
  readonly cells: number; // at most
  readonly outlines: boolean;
}

/** At rest: all there is. */
export const FULL: Quality = { pixelRatio: 1, cells: Number.POSITIVE_INFINITY, outlines: true };
/** When nothing has changed for a while, where edges are not smoothed by the graphics processor: by drawing them larger. */
export const SMOOTH: Quality = { ...FULL, pixelRatio: 2 };

/** While the view moves. */
export const LEVELS: readonly Quality[] = [
  { pixelRatio: 1, cells: 400_000, outlines: true },
  { pixelRatio: 1, cells: 100_000, outlines: true },
  { pixelRatio: 0.75, cells: 40_000, outlines: true },
  { pixelRatio: 0.6, cells: 16_000, outlines: true },
  { pixelRatio: 0.5, cells: 10_000, outlines: true },
  { pixelRatio: 0.4, cells: 6_000, outlines: false },
  { pixelRatio: 0.3, cells: 3_000, outlines: false },
];
const SLOW_MS = 26; // some way from the 33 ms of 30 frames a second, which are promised
const FAST_MS = 18;
const WINDOW = 6; // frames that are judged together, by their mean: single ones are multiples of the screen's period
const WORTH = 0.9; // a level that takes more than this share of the time of the one above is not worth what it leaves out
const PATIENCE = 8; // windows until a level is tried again

/** Finds the level at which frames come often enough, from the times between them. */
export class QualityControl {
  private level: number;
  private window: number[] = [];
  private above_ms = Number.POSITIVE_INFINITY; // mean of the level above, when it was left as too slow
  private fastWindows = 0;
  private waitWindows = 0;

  /** @param software there is no graphics processor: begin with little */
  constructor(software: boolean) {
    this.level = software ? 3 : 0;
  }

  get current(): Quality {
    return LEVELS[this.level]!;
  }

  /** Takes note of the time since the last frame of one movement. */
  frame(elapsed_ms: number): void {
    this.window.push(elapsed_ms);
    if (this.window.length < WINDOW) return;
    const mean = this.window.reduce((sum, time) => sum + time, 0) / WINDOW;
    this.window = [];
    this.judge(mean);
  }

  private judge(mean_ms: number): void {
    this.fastWindows = mean_ms < FAST_MS ? this.fastWindows + 1 : 0;
    if (this.waitWindows > 0) --this.waitWindows;
    if (mean_ms > SLOW_MS && mean_ms > WORTH * this.above_ms) {
      this.level -= 1; // what was left out did not help: something else is slow
      this.above_ms = Number.POSITIVE_INFINITY;
      this.waitWindows = PATIENCE;
    } else if (mean_ms > SLOW_MS && this.level < LEVELS.length - 1 && this.waitWindows === 0) {
      this.level += 1;
      this.above_ms = mean_ms;
    } else if (this.fastWindows >= PATIENCE && this.level > 0) {
      this.level -= 1;
      this.above_ms = Number.POSITIVE_INFINITY;
      this.fastWindows = 0;
    }
  }
}
