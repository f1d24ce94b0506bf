import { PLANE_CLASSES, type PlaneRecord } from '../api/planes';
import { niceSteps, oklch, quantile, type Rgb, sequential } from './scale';
import type { Theme } from './theme';

/** What planes are coloured by. */
export type PlaneColouring = 'plane' | 'class' | 'normal' | 'offset';

export interface ScaleLegend {
  readonly kind: 'scale';
  readonly title: string;
  readonly unit: string;
  readonly minimum: number; // in the unit; 0: the scale is linear, else logarithmic
  readonly maximum: number;
}

export interface SwatchLegend {
  readonly kind: 'swatches';
  readonly title: string;
  readonly swatches: readonly { readonly label: string; readonly colour: Rgb }[];
}

export type Legend = ScaleLegend | SwatchLegend;

export interface PlaneColours {
  readonly of: (plane: PlaneRecord) => Rgb;
  readonly legend: Legend | null;
}

export const toDegrees = (rad: number): number => (rad * 180) / Math.PI;

/** Neighbours in id are far apart in hue: 137.5°, the golden angle. */
export function planeColour(id: number, theme: Theme): Rgb {
  return oklch(theme.planeLightness + 0.06 * ((id % 3) - 1), 0.09, (id * 137.508) % 360);
}

function byDeviation(
  planes: readonly PlaneRecord[],
  title: string,
  unit: string,
  inUnit: (p: PlaneRecord) => number,
): PlaneColours {
  const values = planes.map(inUnit).filter(value => value > 0);
  const maximum = niceSteps(quantile(values, 0.98) || 1).ceiling;
  const minimum = Math.min(niceSteps(quantile(values, 0.02) || maximum).floor, maximum / 10);
  const decades = Math.log10(maximum / minimum);
  return {
    of: plane => sequential(Math.log10(Math.max(inUnit(plane), minimum) / minimum) / decades),
    legend: { kind: 'scale', title, unit, minimum, maximum },
  };
}

/** Colours of these planes. Scales are logarithmic, as deviations span decades; all but 2 of 100 planes lie within each end. */
export function planeColours(colouring: PlaneColouring, planes: readonly PlaneRecord[], theme: Theme): PlaneColours {
  switch (colouring) {
    case 'plane':
      return { of: plane => planeColour(plane.id, theme), legend: null };
    case 'class': {
      const present = new Set(planes.map(plane => plane.class));
      const swatches = PLANE_CLASSES.filter(c => present.has(c)).map(c => ({ label: c, colour: theme.classes[c] }));
      return { of: plane => theme.classes[plane.class], legend: { kind: 'swatches', title: 'Class', swatches } };
    }
    case 'normal':
      return byDeviation(planes, '\u00b1 of the normal', '°', plane => toDegrees(plane.normalDeviation));
    case 'offset':
      return byDeviation(planes, '\u00b1 of the offset', 'mm', plane => 1000 * plane.offsetDeviation);
  }
}
