/** How much is drawn while the view moves. At rest all of it is. */
export interface Quality {
  readonly pixelRatio: number; // of the screen's own
  readonly cells: number; // at most
  readonly outlines: boolean;
}

const LEVELS: readonly Quality[] = [
  { pixelRatio: 1, cells: 400_000, outlines: true },
  { pixelRatio: 1, cells: 100_000, outlines: true },
  { pixelRatio: 0.75, cells: 40_000, outlines: true },
  { pixelRatio: 0.6, cells: 16_000, outlines: true },
  { pixelRatio: 0.5, cells: 10_000, outlines: true },
  { pixelRatio: 0.4, cells: 6_000, outlines: false },
  { pixelRatio: 0.3, cells: 3_000, outlines: false },
];
const SLOW_MS = 27;
const FAST_MS = 18;
const SLOW_FRAMES = 3;
const FAST_FRAMES = 40;

/** Finds the level at which frames come often enough, from the times between them. */
export class QualityControl {
  private level: number;
  private slow = 0;
  private fast = 0;

  /** @param software there is no graphics processor: begin with little */
  constructor(software: boolean) {
    this.level = software ? 3 : 0;
  }

  get current(): Quality {
    return LEVELS[this.level]!;
  }

  /** Takes note of the time since the last frame of one movement. */
  frame(elapsed_ms: number): void {
    this.slow = elapsed_ms > SLOW_MS ? this.slow + 1 : 0;
    this.fast = elapsed_ms < FAST_MS ? this.fast + 1 : 0;
    if (this.slow >= SLOW_FRAMES && this.level < LEVELS.length - 1) this.go(+1);
    if (this.fast >= FAST_FRAMES && this.level > 0) this.go(-1);
  }

  private go(step: number): void {
    this.level += step;
    this.slow = 0;
    this.fast = 0;
  }
}
