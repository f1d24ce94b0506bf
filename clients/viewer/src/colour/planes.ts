import { PLANE_CLASSES, type PlaneRecord } from '../api/planes';
import { niceCeiling, oklch, quantile, type Rgb, sequential } from './scale';
import type { Theme } from './theme';

/** What planes are coloured by. */
export type PlaneColouring = 'plane' | 'class' | 'normal' | 'offset';

export interface ScaleLegend {
  readonly kind: 'scale';
  readonly title: string;
  readonly unit: string;
  readonly maximum: number; // in the unit
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
  return oklch(theme.planeLightness + 0.06 * ((id % 3) - 1), 0.105, (id * 137.508) % 360);
}

function byDeviation(
  planes: readonly PlaneRecord[],
  title: string,
  unit: string,
  inUnit: (p: PlaneRecord) => number,
): PlaneColours {
  const maximum = niceCeiling(quantile(planes.map(inUnit), 0.95));
  return { of: plane => sequential(inUnit(plane) / maximum), legend: { kind: 'scale', title, unit, maximum } };
}

/** Colours of these planes. The ends of a scale follow the planes: 0 to what 95 of 100 stay below. */
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
      return byDeviation(planes, 'Normal, standard deviation', '°', plane => toDegrees(plane.normalDeviation));
    case 'offset':
      return byDeviation(planes, 'Offset, standard deviation', 'mm', plane => 1000 * plane.offsetDeviation);
  }
}
