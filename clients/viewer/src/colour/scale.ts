/** Colours as sRGB bytes. They go to the screen as they are: nothing in this scene is lit, so nothing needs linear colours. */
export type Rgb = readonly [number, number, number];

export const toCss = ([r, g, b]: Rgb): string => `rgb(${r} ${g} ${b})`;

export function mix(a: Rgb, b: Rgb, share: number): Rgb {
  const at = (i: 0 | 1 | 2) => Math.round(a[i] + (b[i] - a[i]) * share);
  return [at(0), at(1), at(2)];
}

/**
 * Stops of "viridis" (Smith and van der Walt, 2015) without its darkest fifth, which would be lost on a dark background: grows
 * evenly in lightness, and reads alike for people who see red and green alike.
 */
const STOPS: readonly Rgb[] = [
  [65, 68, 135],
  [53, 95, 141],
  [42, 120, 142],
  [33, 145, 140],
  [34, 168, 132],
  [68, 191, 112],
  [122, 209, 81],
  [189, 223, 38],
  [253, 231, 37],
];

/** A colour for 0 (certain) to 1 (uncertain); outside: the ends. */
export function sequential(share: number): Rgb {
  const at = Math.min(1, Math.max(0, share)) * (STOPS.length - 1);
  const low = Math.min(Math.floor(at), STOPS.length - 2);
  return mix(STOPS[low]!, STOPS[low + 1]!, at - low);
}

/** The steps 1, 2, 5, 10, 20, ... (and 0.5, 0.2, ...) next to a value: the least not below it and the greatest not above. */
export function niceSteps(value: number): { floor: number; ceiling: number } {
  const power = 10 ** Math.floor(Math.log10(value));
  const steps = [0.5, 1, 2, 5, 10].map(step => Number((step * power).toPrecision(1)));
  return {
    floor: steps.findLast(step => step <= value * (1 + 1e-9))!,
    ceiling: steps.find(step => step >= value * (1 - 1e-9))!,
  };
}

/** The value below which the share of the values lies; 0 of none. */
export function quantile(values: readonly number[], share: number): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
}

/** oklch with full alpha to sRGB bytes, clipped (Ottosson, 2020). Hue in degrees. */
export function oklch(lightness: number, chroma: number, hue: number): Rgb {
  const a = chroma * Math.cos((hue * Math.PI) / 180);
  const b = chroma * Math.sin((hue * Math.PI) / 180);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const linear = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  const [red, green, blue] = linear.map(c => {
    const clipped = Math.min(1, Math.max(0, c));
    return Math.round(255 * (clipped <= 0.0031308 ? 12.92 * clipped : 1.055 * clipped ** (1 / 2.4) - 0.055));
  });
  return [red!, green!, blue!];
}
