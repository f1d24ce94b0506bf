import { PerspectiveCamera, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import type { Vec3 } from '../../src/api/check';
import { boundsOf } from '../../src/map/bounds';
import { hitPlane, pickPlane } from '../../src/map/pick';
import { tessellate } from '../../src/map/tessellate';
import { cross, dot, length, planeBasis, subtract } from '../../src/map/vector';
import { pickWall, wallLines } from '../../src/map/wall_lines';
import { fitView } from '../../src/scene/fitting';
import { plane, rectangle } from './records';

/** Area that the triangles cover, counted negative where they face away from the normal. */
function signedArea(record: ReturnType<typeof plane>): number {
  const { positions, triangles } = tessellate(record);
  const at = (vertex: number): Vec3 => [positions[3 * vertex]!, positions[3 * vertex + 1]!, positions[3 * vertex + 2]!];
  let area = 0;
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [at(triangles[i]!), at(triangles[i + 1]!), at(triangles[i + 2]!)];
    area += dot(cross(subtract(b, a), subtract(c, a)), record.normal) / 2;
  }
  return area;
}

describe('planeBasis', () => {
  it.each<Vec3>([
    [0, 0, 1],
    [0, 0, -1],
    [1, 0, 0],
    [0, -1, 0],
    [0.6, 0, 0.8],
    [0.48, 0.6, 0.64],
  ])('is right-handed and of length 1 about %j', (...normal) => {
    const { u, v } = planeBasis(normal);
    expect(length(u)).toBeCloseTo(1, 12);
    expect(dot(u, normal)).toBeCloseTo(0, 12);
    cross(u, v).forEach((x, i) => {
      expect(x).toBeCloseTo(normal[i]!, 12);
    });
  });
});

describe('tessellate', () => {
  const hole = rectangle(0.5, 0.25, 1, 0.75).reverse();

  it('covers a rectangle but for its hole, and faces the normal', () => {
    const record = plane({ polygons: [{ outer: rectangle(0, 0, 2, 1), holes: [hole] }] });
    expect(signedArea(record)).toBeCloseTo(2 - 0.25, 6);
  });

  it('faces the normal also below', () => {
    const record = plane({ normal: [0, 0, -1], polygons: [{ outer: rectangle(0, 0, 2, 1).reverse(), holes: [] }] });
    expect(signedArea(record)).toBeCloseTo(2, 6);
  });

  it('takes several polygons, and their rings as segments', () => {
    const polygons = [
      { outer: rectangle(0, 0, 2, 1), holes: [hole] },
      { outer: rectangle(5, 0, 6, 1), holes: [] },
    ];
    const record = plane({ polygons });
    expect(signedArea(record)).toBeCloseTo(1.75 + 1, 6);
    expect(tessellate(record).segments.length).toBe(2 * (4 + 4 + 4));
  });

  it('takes a ring that is not convex', () => {
    const outer: Vec3[] = [
      [0, 0, 0],
      [2, 0, 0],
      [2, 2, 0],
      [1, 0.5, 0],
      [0, 2, 0],
    ]; // prettier-ignore
    expect(signedArea(plane({ polygons: [{ outer, holes: [] }] }))).toBeCloseTo(4 - 1.5, 6);
  });
});

describe('hitPlane', () => {
  const holed = plane({ polygons: [{ outer: rectangle(0, 0, 2, 1), holes: [rectangle(0.5, 0.25, 1, 0.75)] }] });
  const down: Vec3 = [0, 0, -1];

  it('tells how far it is', () => expect(hitPlane(holed, [0.2, 0.2, 3], down)).toBeCloseTo(3, 12));
  it('misses beside the outer ring', () => expect(hitPlane(holed, [2.1, 0.2, 3], down)).toBeNull());
  it('goes through a hole', () => expect(hitPlane(holed, [0.7, 0.5, 3], down)).toBeNull());
  it('goes through from behind', () => expect(hitPlane(holed, [0.2, 0.2, -3], [0, 0, 1])).toBeNull());
  it('does not look back', () => expect(hitPlane(holed, [0.2, 0.2, -3], down)).toBeNull());

  it('agrees with the triangles that are drawn, on many rays', () => {
    let hits = 0;
    const { positions, triangles } = tessellate(holed);
    for (let i = 0; i < 400; ++i) {
      const [x, y] = [((i * 37) % 101) / 45 - 0.1003, ((i * 53) % 97) / 80 - 0.1003];
      let drawn = false;
      for (let t = 0; t < triangles.length; t += 3) {
        const corner = (k: number) =>
          [positions[3 * triangles[t + k]!]!, positions[3 * triangles[t + k]! + 1]!] as const;
        const side = (k: number) => {
          const [[ax, ay], [bx, by]] = [corner(k), corner((k + 1) % 3)];
          return (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0;
        };
        drawn ||= side(0) && side(1) && side(2);
      }
      expect(hitPlane(holed, [x, y, 1], down) !== null, `(${x}, ${y})`).toBe(drawn);
      if (drawn) ++hits;
    }
    expect(hits).toBeGreaterThan(100);
  });
});

describe('pickPlane', () => {
  it('takes the first that is met', () => {
    const table = plane({ id: 2, d: -0.7, polygons: [{ outer: rectangle(0, 0, 1, 1, 0.7), holes: [] }] });
    expect(pickPlane([plane(), table], [0.5, 0.5, 3], [0, 0, -1])?.id).toBe(2);
    expect(pickPlane([plane(), table], [1.5, 0.5, 3], [0, 0, -1])?.id).toBe(1);
    expect(pickPlane([plane(), table], [9, 9, 3], [0, 0, -1])).toBeNull();
  });
});

describe('wallLines', () => {
  const upright = (y0: number, y1: number): Vec3[] => [
    [3, y0, 0],
    [3, y1, 0],
    [3, y1, 2.4],
    [3, y0, 2.4],
  ]; // prettier-ignore
  const wall = (...polygons: Vec3[][]) =>
    plane({
      id: 7,
      normal: [1, 0, 0],
      d: -3,
      centroid: [3, 1, 1],
      polygons: polygons.map(outer => ({ outer, holes: [] })),
    });

  it('is a line at the upper edge of a wall', () => {
    const [line, ...others] = wallLines(wall(upright(0, 2)));
    expect(others).toEqual([]);
    const ends = [line!.from, line!.to].sort((a, b) => a[1] - b[1]);
    expect(ends.flat()).toEqual([3, 0, 2.4, 3, 2, 2.4]);
  });

  it('joins polygons that overlap and keeps those apart that do not', () => {
    expect(wallLines(wall(upright(0, 2), upright(1, 3)))).toHaveLength(1);
    expect(wallLines(wall(upright(0, 1), upright(2, 3)))).toHaveLength(2);
  });

  it('is nothing of a floor', () => expect(wallLines(plane())).toEqual([]));

  it('is found within reach', () => {
    const lines = wallLines(wall(upright(0, 2)));
    expect(pickWall(lines, 3.05, 1, 0.1)?.id).toBe(7);
    expect(pickWall(lines, 3.15, 1, 0.1)).toBeNull();
    expect(pickWall(lines, 3, 2.05, 0.1)?.id).toBe(7); // beyond its end
    expect(pickWall(lines, 3, 2.2, 0.1)).toBeNull();
  });
});

describe('boundsOf', () => {
  it('is the box about all rings', () => expect(boundsOf([plane()])).toEqual({ min: [0, 0, 0], max: [2, 1, 0] }));
  it('is null of nothing', () => expect(boundsOf([])).toBeNull());
});

describe('fitView', () => {
  const corners = (x0: number) =>
    new Float32Array([-1, 1].flatMap(x => [-1, 1].flatMap(y => [-1, 1].flatMap(z => [x + x0, y, z]))));
  const above = new Vector3(0, 0, 1);

  it('has the nearest face of a cube fill the view from above', () => {
    // Half the face is 1, so 1 / tan = 2 from the face, which is 1 above the middle.
    const fit = fitView([corners(0)], above, 0.5, 0.5)!;
    expect(fit.distance).toBeCloseTo(3, 6);
    expect(fit.target.toArray()).toEqual([0, 0, 0]);
  });

  it('looks at the middle of what is there', () =>
    expect(fitView([corners(5), corners(9)], above, 0.5, 0.5)!.target.x).toBeCloseTo(7, 6));

  it('has all in view from aside, and something at each of two opposite edges', () => {
    const offset = new Vector3(-0.5, -0.6, 0.7).normalize();
    const fit = fitView([corners(3)], offset, 0.6, 0.4)!;
    const camera = new PerspectiveCamera((2 * Math.atan(0.4) * 180) / Math.PI, 0.6 / 0.4);
    camera.up.set(0, 0, 1);
    camera.position.copy(fit.target).addScaledVector(offset, fit.distance);
    camera.lookAt(fit.target);
    camera.updateMatrixWorld();
    const cloud = corners(3);
    const seen = Array.from({ length: 8 }, (_, i) => new Vector3().fromArray(cloud, 3 * i).project(camera));
    const ends = [seen.map(p => p.x), seen.map(p => p.y)].map(v => [Math.min(...v), Math.max(...v)] as const);
    for (const [low, high] of ends) expect(low).toBeCloseTo(-high, 1);
    expect(Math.max(...ends.map(([, high]) => high))).toBeCloseTo(1, 2);
  });

  it('is nothing of nothing', () => expect(fitView([], above, 0.5, 0.5)).toBeNull());
});
