import type { Vec3 } from '../api/check';
import type { PlaneRecord } from '../api/planes';
import { add, dot, length, normalize, planeBasis, scale, subtract } from './vector';

/** A value with its standard deviation, in the value's unit. */
export interface Estimate {
  readonly value: number;
  readonly sigma: number;
}

export interface Measurement {
  /** Between the planes, 0 to π/2. */
  readonly angle: Estimate;
  readonly distance: Estimate;
  /** True: distance of the two planes at the middle between their centroids. False: of b's centroid from plane a. */
  readonly parallel: boolean;
  /** Ends of the distance, map frame: on a and on b. */
  readonly from: Vec3;
  readonly to: Vec3;
}

/** Up to this angle planes are measured as parallel ones. */
export const PARALLEL_RAD = (10 * Math.PI) / 180;

/** xᵀ C x with the upper left of a row-major 4x4 matrix. */
function quadraticForm(covariance: readonly number[], x: readonly number[]): number {
  let sum = 0;
  for (let row = 0; row < x.length; ++row) {
    for (let column = 0; column < x.length; ++column) sum += x[row]! * covariance[4 * row + column]! * x[column]!;
  }
  return Math.max(0, sum);
}

export function signedDistance(plane: PlaneRecord, point: Vec3): number {
  return dot(plane.normal, point) + plane.d;
}

/** Variance, m², of n · p + d at a fixed point p: (p, 1)ᵀ Σ (p, 1). */
export function offsetVariance(plane: PlaneRecord, point: Vec3): number {
  return quadraticForm(plane.covariance, [...point, 1]);
}

/**
 * Angle between two planes, first order, errors of the two taken as independent. It turns by what the normals turn towards or from
 * each other: σ² = uᵀ Σa u + wᵀ Σb w with u, w the directions of that turn at each normal. Exactly parallel planes have no such
 * direction; theirs is the one in which the normals are known the least.
 */
export function angleBetween(a: PlaneRecord, b: PlaneRecord): Estimate {
  const sign = dot(a.normal, b.normal) < 0 ? -1 : 1;
  const other = scale(b.normal, sign);
  const sine = length(subtract(other, scale(a.normal, dot(a.normal, other))));
  const value = Math.atan2(sine, dot(a.normal, other));
  if (sine < 1e-9) {
    const { u, v } = planeBasis(a.normal);
    const steps = Array.from({ length: 180 }, (_, i) => (i * Math.PI) / 180);
    const variances = steps.map(t => {
      const direction = add(scale(u, Math.cos(t)), scale(v, Math.sin(t)));
      return quadraticForm(a.covariance, direction) + quadraticForm(b.covariance, direction);
    });
    return { value, sigma: Math.sqrt(Math.max(...variances)) };
  }
  const u = normalize(subtract(other, scale(a.normal, dot(a.normal, other))));
  const w = normalize(subtract(a.normal, scale(other, dot(a.normal, other))));
  return { value, sigma: Math.sqrt(quadraticForm(a.covariance, u) + quadraticForm(b.covariance, w)) };
}

/** Distance and angle of two planes with their standard deviations, from the planes' covariances. */
export function measure(a: PlaneRecord, b: PlaneRecord): Measurement {
  const angle = angleBetween(a, b);
  const parallel = angle.value <= PARALLEL_RAD;
  const point = parallel ? scale(add(a.centroid, b.centroid), 0.5) : b.centroid;
  const sa = signedDistance(a, point);
  const sb = signedDistance(b, point);
  const cosine = dot(a.normal, b.normal);
  const share = parallel ? Math.sign(cosine) : cosine; // of b's offset that moves along a's normal
  return {
    angle,
    parallel,
    distance: {
      value: Math.abs(parallel ? sa - share * sb : sa),
      sigma: Math.sqrt(offsetVariance(a, point) + share ** 2 * offsetVariance(b, point)),
    },
    from: subtract(point, scale(a.normal, sa)),
    to: subtract(point, scale(b.normal, sb)),
  };
}
