import type { Vec3 } from '../api/check';
import type { PlaneRecord } from '../api/planes';

export interface Bounds {
  readonly min: Vec3;
  readonly max: Vec3;
}

export const centreOf = ({ min, max }: Bounds): Vec3 => [
  (min[0] + max[0]) / 2,
  (min[1] + max[1]) / 2,
  (min[2] + max[2]) / 2,
];
export const sizeOf = ({ min, max }: Bounds): Vec3 => [max[0] - min[0], max[1] - min[1], max[2] - min[2]];

/** The box about the planes' polygons; null of none. */
export function boundsOf(planes: Iterable<PlaneRecord>): Bounds | null {
  const min: [number, number, number] = [Infinity, Infinity, Infinity];
  const max: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (const plane of planes) {
    for (const { outer } of plane.polygons) {
      for (const point of outer) {
        for (const i of [0, 1, 2] as const) {
          min[i] = Math.min(min[i], point[i]);
          max[i] = Math.max(max[i], point[i]);
        }
      }
    }
  }
  return min[0] <= max[0] ? { min, max } : null;
}
