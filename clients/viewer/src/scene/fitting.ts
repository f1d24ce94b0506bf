import { Vector3 } from 'three';

/** Points x, y, z, ... of the map frame, m. */
export type Points = Float32Array;

export interface Fit {
  readonly target: Vector3; // what the camera looks at
  readonly distance: number; // from there, m
}

const ROUNDS = 4;

/**
 * Where a camera that looks against `offset` must be for all points to be in view, in its middle and as large as they may be.
 * @param offset unit vector from the target towards the camera
 * @param across, upright tangents of half the angles of view
 */
export function fitView(clouds: readonly Points[], offset: Vector3, across: number, upright: number): Fit | null {
  const right = new Vector3(0, 0, 1).cross(offset);
  if (right.lengthSq() < 1e-12) right.set(1, 0, 0);
  right.normalize();
  const up = offset.clone().cross(right);
  const points = clouds.flatMap(cloud => inAxes(cloud, right, up, offset));
  if (points.length === 0) return null;
  const range = (of: (p: Local) => number) => {
    let [low, high] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
    for (const point of points) {
      const value = of(point);
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    return [low, high] as const;
  };
  const middle = ([low, high]: readonly [number, number]) => (low + high) / 2;
  const target: [number, number, number] = [
    middle(range(p => p[0])),
    middle(range(p => p[1])),
    middle(range(p => p[2])),
  ];
  const distanceNow = () =>
    range(
      p => p[2] - target[2] + Math.max(Math.abs(p[0] - target[0]) / across, Math.abs(p[1] - target[1]) / upright),
    )[1];
  let distance = distanceNow();
  for (let round = 0; round < ROUNDS; ++round) {
    const depth = (p: Local) => Math.max(1e-6, distance - (p[2] - target[2]));
    const shiftX = middle(range(p => (p[0] - target[0]) / depth(p))) * distance;
    const shiftY = middle(range(p => (p[1] - target[1]) / depth(p))) * distance;
    target[0] += shiftX;
    target[1] += shiftY;
    distance = distanceNow();
  }
  return {
    target: new Vector3()
      .addScaledVector(right, target[0])
      .addScaledVector(up, target[1])
      .addScaledVector(offset, target[2]),
    distance,
  };
}

type Local = readonly [right: number, up: number, towards: number];

function inAxes(cloud: Points, right: Vector3, up: Vector3, offset: Vector3): Local[] {
  const local: Local[] = [];
  const point = new Vector3();
  for (let i = 0; i < cloud.length; i += 3) {
    point.fromArray(cloud, i);
    local.push([point.dot(right), point.dot(up), point.dot(offset)]);
  }
  return local;
}
