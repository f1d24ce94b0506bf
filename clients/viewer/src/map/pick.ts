import type { Vec3 } from '../api/check';
import type { PlaneRecord } from '../api/planes';
import { add, dot, planeBasis, scale } from './vector';

type Flat = readonly [number, number];

/** Whether the point is within the ring: even-odd rule. */
function insideRing(ring: readonly Vec3[], u: Vec3, v: Vec3, [x, y]: Flat): boolean {
  let inside = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const [xi, yi, xj, yj] = [dot(ring[i]!, u), dot(ring[i]!, v), dot(ring[j]!, u), dot(ring[j]!, v)];
    if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) inside = !inside;
  }
  return inside;
}

/** Where the ray meets the plane's polygons from the side that is drawn, in lengths of the direction; null: nowhere. */
export function hitPlane(plane: PlaneRecord, origin: Vec3, direction: Vec3): number | null {
  const approach = dot(plane.normal, direction);
  if (approach >= -1e-9) return null; // from behind, or along it
  const t = -(dot(plane.normal, origin) + plane.d) / approach;
  if (t <= 0) return null;
  const point = add(origin, scale(direction, t));
  const { u, v } = planeBasis(plane.normal);
  const flat: Flat = [dot(point, u), dot(point, v)];
  const hit = plane.polygons.some(
    ({ outer, holes }) => insideRing(outer, u, v, flat) && !holes.some(hole => insideRing(hole, u, v, flat)),
  );
  return hit ? t : null;
}

/** The first of the planes that the ray meets. */
export function pickPlane(planes: Iterable<PlaneRecord>, origin: Vec3, direction: Vec3): PlaneRecord | null {
  let [best, nearest]: [PlaneRecord | null, number] = [null, Number.POSITIVE_INFINITY];
  for (const plane of planes) {
    const t = hitPlane(plane, origin, direction);
    if (t !== null && t < nearest) [best, nearest] = [plane, t];
  }
  return best;
}
