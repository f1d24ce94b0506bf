import { ShapeUtils, Vector2 } from 'three';
import type { Vec3 } from '../api/check';
import type { PlaneRecord, Polygon } from '../api/planes';
import { dot, planeBasis } from './vector';

/** A plane's polygons as triangles that face the normal's side, and as the segments of their rings. Metres, map frame. */
export interface Tessellation {
  readonly positions: Float32Array; // x, y, z of each vertex
  readonly triangles: Uint32Array; // three vertices each
  readonly segments: Uint32Array; // two vertices each
}

const cache = new WeakMap<PlaneRecord, Tessellation>();

/** Made once for each record. */
export function tessellate(plane: PlaneRecord): Tessellation {
  let known = cache.get(plane);
  if (!known) {
    known = tessellateNow(plane);
    cache.set(plane, known);
  }
  return known;
}

function tessellateNow(plane: PlaneRecord): Tessellation {
  const { u, v } = planeBasis(plane.normal);
  const flat = (ring: readonly Vec3[]) => ring.map(p => new Vector2(dot(p, u), dot(p, v)));
  const positions: number[] = [];
  const triangles: number[] = [];
  const segments: number[] = [];
  for (const polygon of plane.polygons) {
    const first = positions.length / 3;
    appendRings(polygon, positions, segments);
    const outer = flat(polygon.outer);
    const holes = polygon.holes.map(flat);
    const corners = [outer, ...holes].flat();
    for (const [a, b, c] of ShapeUtils.triangulateShape(outer, holes) as [number, number, number][]) {
      const counterClockwise = ShapeUtils.area([corners[a]!, corners[b]!, corners[c]!]) >= 0;
      triangles.push(first + a, first + (counterClockwise ? b : c), first + (counterClockwise ? c : b));
    }
  }
  return {
    positions: new Float32Array(positions),
    triangles: new Uint32Array(triangles),
    segments: new Uint32Array(segments),
  };
}

function appendRings(polygon: Polygon, positions: number[], segments: number[]): void {
  for (const ring of [polygon.outer, ...polygon.holes]) {
    const first = positions.length / 3;
    ring.forEach((point, i) => {
      positions.push(...point);
      segments.push(first + i, first + ((i + 1) % ring.length));
    });
  }
}
