import type { PlaneClass, PlaneRecord } from '../api/planes';

export interface PlaneFilter {
  readonly hiddenClasses: ReadonlySet<PlaneClass>;
  readonly leastArea_m2: number;
  readonly largestDeviation_rad: number; // of the normal; Infinity: no limit
}

export const NO_FILTER: PlaneFilter = {
  hiddenClasses: new Set(),
  leastArea_m2: 0,
  largestDeviation_rad: Number.POSITIVE_INFINITY,
};

export function accepts(filter: PlaneFilter, plane: PlaneRecord): boolean {
  return (
    !filter.hiddenClasses.has(plane.class) &&
    plane.area >= filter.leastArea_m2 &&
    plane.normalDeviation <= filter.largestDeviation_rad
  );
}
