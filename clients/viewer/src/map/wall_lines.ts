import type { Vec3 } from '../api/check';
import type { PlaneRecord } from '../api/planes';
import { dot, planeBasis } from './vector';

/** A stretch of a wall, seen from above: metres, map frame. */
export interface WallLine {
  readonly plane: PlaneRecord;
  readonly from: Vec3;
  readonly to: Vec3;
}

const STEEPEST = 0.35; // of the normal's z: planes that stand within 20° of upright

/** Each polygon of an upright plane as a line at its upper edge; overlapping ones are one. */
export function wallLines(plane: PlaneRecord): WallLine[] {
  if (Math.abs(plane.normal[2]) > STEEPEST) return [];
  const { u } = planeBasis(plane.normal); // horizontal
  const ranges = plane.polygons
    .map(({ outer }) => outer.map(p => dot(p, u)))
    .map(along => ({ low: Math.min(...along), high: Math.max(...along) }))
    .sort((a, b) => a.low - b.low);
  const merged: { low: number; high: number }[] = [];
  for (const range of ranges) {
    const last = merged.at(-1);
    if (last && range.low <= last.high) last.high = Math.max(last.high, range.high);
    else merged.push({ ...range });
  }
  const top = Math.max(...plane.polygons.flatMap(({ outer }) => outer.map(p => p[2])));
  const across = dot(plane.centroid, [-u[1], u[0], 0]);
  const at = (along: number): Vec3 => [u[0] * along - u[1] * across, u[1] * along + u[0] * across, top];
  return merged.map(({ low, high }) => ({ plane, from: at(low), to: at(high) }));
}

/** The plane whose line is nearest to (x, y), not farther than `within_m`. */
export function pickWall(lines: readonly WallLine[], x: number, y: number, within_m: number): PlaneRecord | null {
  let [best, nearest]: [PlaneRecord | null, number] = [null, within_m];
  for (const { plane, from, to } of lines) {
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    const along = ((x - from[0]) * dx + (y - from[1]) * dy) / Math.max(1e-12, dx * dx + dy * dy);
    const t = Math.min(1, Math.max(0, along));
    const distance = Math.hypot(from[0] + t * dx - x, from[1] + t * dy - y);
    if (distance <= nearest) [best, nearest] = [plane, distance];
  }
  return best;
}
