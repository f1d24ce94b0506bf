import type { PlaneClass } from '../api/planes';
import { oklch, type Rgb } from './scale';

/** What the scene is drawn in. The page around it takes its colours from style/theme.css. */
export interface Theme {
  readonly name: 'light' | 'dark';
  readonly background: Rgb;
  readonly outline: Rgb;
  readonly grid: Rgb;
  readonly accent: Rgb; // what is selected
  readonly second: Rgb; // the other plane of a measurement
  readonly robot: Rgb;
  readonly scan: Rgb;
  readonly unknown: Rgb; // cells without a normal
  readonly classes: Readonly<Record<PlaneClass, Rgb>>;
  readonly planeLightness: number;
}

const classes = (lightness: number, chroma: number): Record<PlaneClass, Rgb> => ({
  floor: oklch(lightness, chroma, 150),
  ceiling: oklch(lightness + 0.06, chroma * 0.55, 215),
  wall: oklch(lightness, chroma * 0.75, 255),
  table: oklch(lightness + 0.04, chroma * 1.2, 70),
  slope: oklch(lightness, chroma * 1.2, 320),
  other: oklch(lightness, 0.012, 260),
});

export const THEMES: Readonly<Record<'light' | 'dark', Theme>> = {
  dark: {
    name: 'dark',
    background: [17, 20, 24],
    outline: [196, 206, 218],
    grid: [38, 44, 52],
    accent: [255, 158, 74],
    second: [94, 214, 232],
    robot: [255, 255, 255],
    scan: [255, 106, 128],
    unknown: [92, 99, 110],
    classes: classes(0.6, 0.09),
    planeLightness: 0.62,
  },
  light: {
    name: 'light',
    background: [243, 244, 242],
    outline: [58, 66, 76],
    grid: [222, 225, 226],
    accent: [214, 92, 0],
    second: [0, 126, 156],
    robot: [20, 24, 28],
    scan: [200, 22, 62],
    unknown: [168, 174, 180],
    classes: classes(0.76, 0.085),
    planeLightness: 0.78,
  },
};
