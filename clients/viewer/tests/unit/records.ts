import type { Vec3 } from '../../src/api/check';
import type { PlaneRecord } from '../../src/api/planes';

/** A rectangle of a plane, as planes.json has it; what is given wins. */
export function planeJson(given: Readonly<Record<string, unknown>> = {}): Record<string, unknown> {
  return {
    id: 1,
    normal: [0, 0, 1],
    d: 0,
    covariance: new Array(16).fill(0),
    centroid: [1, 0.5, 0],
    area: 2,
    polygons: [{ outer: rectangle(0, 0, 2, 1), holes: [] }],
    cellCount: 10,
    pointCount: 100,
    class: 'floor',
    quality: 0.9,
    firstSeenUtime: 1_000_000,
    lastSeenUtime: 2_000_000,
    normalDeviation: 0.001,
    offsetDeviation: 0.002,
    coplanar: [],
    ...given,
  };
}

export function plane(given: Partial<PlaneRecord> = {}): PlaneRecord {
  return { ...(planeJson() as unknown as PlaneRecord), coplanarWith: [], ...given };
}

/** Counter-clockwise from above. */
export function rectangle(x0: number, y0: number, x1: number, y1: number, z = 0): Vec3[] {
  return [
    [x0, y0, z],
    [x1, y0, z],
    [x1, y1, z],
    [x0, y1, z],
  ];
}

/** 4x4 with these on the diagonal, of (nx, ny, nz, d). */
export function diagonal(nx: number, ny: number, nz: number, d: number): number[] {
  const matrix = new Array(16).fill(0);
  [nx, ny, nz, d].forEach((variance, i) => {
    matrix[5 * i] = variance;
  });
  return matrix;
}
