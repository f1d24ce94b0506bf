import { Vector3 } from 'three';
import { type Bounds, sizeOf } from '../map/bounds';

/**
 * How far from the middle of the box a camera must be for all its corners to be in view.
 * @param offset unit vector from the middle towards the camera
 * @param across, upright tangents of half the angles of view
 */
export function fittingDistance(bounds: Bounds, offset: Vector3, across: number, upright: number): number {
  const [width, depth, height] = sizeOf(bounds);
  const right = new Vector3(0, 0, 1).cross(offset);
  if (right.lengthSq() < 1e-12) right.set(1, 0, 0);
  right.normalize();
  const up = offset.clone().cross(right);
  let distance = 0;
  for (let corner = 0; corner < 8; ++corner) {
    const sign = (bit: number) => (corner & bit ? 0.5 : -0.5);
    const point = new Vector3(sign(1) * width, sign(2) * depth, sign(4) * height);
    const aside = Math.max(Math.abs(point.dot(right)) / across, Math.abs(point.dot(up)) / upright);
    distance = Math.max(distance, point.dot(offset) + aside);
  }
  return distance;
}
