import { describe, expect, it } from 'vitest';
import { angleBetween, measure, offsetVariance } from '../../src/map/measure';
import { diagonal, plane } from './records';

const degrees = (value: number) => (value * Math.PI) / 180;

describe('offsetVariance', () => {
  it('grows with the distance from the origin by the lever of the tilt', () => {
    // (p, 1)' S (p, 1) = 2^2 * 1e-6 + 3^2 * 4e-6 + 9e-6 = 4e-6 + 36e-6 + 9e-6
    const floor = plane({ covariance: diagonal(1e-6, 4e-6, 0, 9e-6) });
    expect(offsetVariance(floor, [2, 3, 0])).toBeCloseTo(49e-6, 12);
  });

  it('counts covariances between the normal and the offset twice', () => {
    const covariance = diagonal(0, 0, 0, 1e-6);
    covariance[3] = covariance[12] = -2e-7; // of nx and d
    expect(offsetVariance(plane({ covariance }), [2, 0, 0])).toBeCloseTo(1e-6 - 2 * 2 * 2e-7, 14);
  });
});

describe('measure of parallel planes', () => {
  // A floor at z = 0 and a ceiling at z = 2.5 that looks down: n = (0, 0, -1), d = 2.5.
  const floor = plane({ id: 1, centroid: [0, 0, 0], covariance: diagonal(0, 0, 0, 9e-6) });
  const ceiling = plane({
    id: 2,
    normal: [0, 0, -1],
    d: 2.5,
    centroid: [2, 0, 2.5],
    covariance: diagonal(0, 0, 0, 16e-6),
  });

  it('is their distance, with both offsets in its deviation', () => {
    const { distance, parallel } = measure(floor, ceiling);
    expect(parallel).toBe(true);
    expect(distance.value).toBeCloseTo(2.5, 12);
    expect(distance.sigma).toBeCloseTo(0.005, 12); // sqrt(9 + 16) mm
  });

  it('is the same the other way round', () => {
    expect(measure(ceiling, floor).distance).toEqual(measure(floor, ceiling).distance);
  });

  it('has the tilt in its deviation, at the middle between the centroids', () => {
    // The middle is (1, 0, 1.25): 1^2 * 4e-6 of the floor's nx, no more.
    const tilting = plane({ ...floor, covariance: diagonal(4e-6, 0, 0, 9e-6) });
    expect(measure(tilting, ceiling).distance.sigma).toBeCloseTo(Math.sqrt(4e-6 + 25e-6), 12);
  });

  it('has its ends on both planes', () => {
    const { from, to } = measure(floor, ceiling);
    [1, 0, 0].forEach((x, i) => {
      expect(from[i]).toBeCloseTo(x, 12);
    });
    [1, 0, 2.5].forEach((x, i) => {
      expect(to[i]).toBeCloseTo(x, 12);
    });
  });

  it('knows planes that look the same way, too', () => {
    const shelf = plane({ d: -0.75, centroid: [0, 0, 0.75] });
    expect(measure(floor, shelf).distance.value).toBeCloseTo(0.75, 12);
  });
});

describe('measure of planes that meet', () => {
  const floor = plane({ covariance: diagonal(1e-6, 0, 0, 0), centroid: [0, 0, 0] });
  const wall = plane({ normal: [1, 0, 0], d: -3, centroid: [3, 1, 1.2], covariance: diagonal(0, 0, 3e-6, 25e-6) });

  it('is a right angle whose deviation is that of the turns towards each other', () => {
    // The floor turns towards the wall by nx, the wall towards the floor by nz.
    const { angle, parallel } = measure(floor, wall);
    expect(parallel).toBe(false);
    expect(angle.value).toBeCloseTo(Math.PI / 2, 12);
    expect(angle.sigma).toBeCloseTo(0.002, 12); // sqrt(1e-6 + 3e-6)
  });

  it('is the distance of the second centroid from the first plane', () => {
    const { distance, to } = measure(floor, wall);
    expect(distance.value).toBeCloseTo(1.2, 12);
    expect(distance.sigma).toBeCloseTo(0.003, 12); // |x| = 3 m of lever times 1 mrad of nx; the wall moves along the floor
    expect(to).toEqual([3, 1, 1.2]);
  });
});

describe('angleBetween', () => {
  const tilted = (angle: number) => plane({ normal: [Math.sin(angle), 0, Math.cos(angle)] });

  it.each([1e-7, 0.1, 5, 45, 89.9])('finds %d degrees', value => {
    expect(angleBetween(plane(), tilted(degrees(value))).value).toBeCloseTo(degrees(value), 12);
  });

  it('is never more than a right angle', () => {
    expect(angleBetween(plane(), tilted(degrees(170))).value).toBeCloseTo(degrees(10), 12);
  });

  it('takes for parallel planes the direction that is known the least', () => {
    const sure = plane({ covariance: diagonal(1e-6, 9e-6, 0, 0) });
    expect(angleBetween(sure, plane({ covariance: diagonal(0, 16e-6, 0, 0) })).sigma).toBeCloseTo(0.005, 12);
  });

  it('agrees with differences of angles of planes that are turned a little', () => {
    const a = plane({ covariance: diagonal(1e-6, 0, 0, 0) });
    const b = tilted(degrees(30));
    const step = 1e-6;
    const turned = plane({ normal: [Math.sin(step), 0, Math.cos(step)] });
    const slope = (angleBetween(turned, b).value - angleBetween(a, b).value) / step;
    expect(angleBetween(a, b).sigma).toBeCloseTo(Math.abs(slope) * 1e-3, 6);
  });
});
