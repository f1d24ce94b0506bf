import { describe, expect, it } from 'vitest';
import { packageFolder } from '../../build/licenses';
import { planeColours } from '../../src/colour/planes';
import { niceSteps, oklch, quantile, sequential } from '../../src/colour/scale';
import { THEMES } from '../../src/colour/theme';
import { LEVELS, QualityControl } from '../../src/scene/quality';
import { degrees, duration, fixed, lastSeen, metres, millimetres, twoDigits, vector } from '../../src/ui/format';
import { scaleBarLength } from '../../src/ui/legend';
import { plane } from './records';

describe('numbers', () => {
  it('have true minus signs and no minus zero', () => {
    expect([fixed(-1.25, 1), fixed(-0.001, 2), vector([-1, 0, 0.5], 1)]).toEqual([
      '\u22121.3',
      '0.00',
      '\u22121.0  0.0  0.5',
    ]);
  });

  it('have as many places as their deviation bears', () => {
    expect(metres(2.43121, 0.0009)).toBe('2.43121 m');
    expect(metres(2.43121, 0.03)).toBe('2.431 m');
    expect(metres(2.43121, 0.5)).toBe('2.43 m');
  });

  it('give deviations two digits', () => {
    expect([0, 0.0123, 0.5, 1.234, 12.34, 123.4].map(twoDigits)).toEqual(['0', '0.012', '0.50', '1.2', '12', '123']);
    expect([millimetres(0.00123), degrees(Math.PI / 180)]).toEqual(['1.2 mm', '1.0°']);
  });

  it('tell times', () => {
    expect([4.04, 60, 300, 7300, 200_000].map(duration)).toEqual(['4.0 s', '60 s', '5 min', '2 h', '2 d']);
    expect(lastSeen(5_000_000, 5_100_000)).toBe('in the last scan');
    expect(lastSeen(5_000_000, 17_000_000)).toBe('12 s before the last scan');
    expect(lastSeen(1_700_000_000_000_000, 1_700_000_000_000_000)).toMatch(/^\d\d:\d\d:\d\d, in the last scan$/);
  });
});

describe('scales', () => {
  it.each([
    [0.3, 0.2, 0.5],
    [1, 1, 1],
    [7, 5, 10],
    [0.011, 0.01, 0.02],
    [99, 50, 100],
  ])('of %d end at %d and %d', (value, floor, ceiling) => expect(niceSteps(value)).toEqual({ floor, ceiling }));

  it('have ends of two colours, and no colours beyond', () => {
    expect(sequential(-1)).toEqual(sequential(0));
    expect(sequential(2)).toEqual([253, 231, 37]);
  });

  it('know shares', () => {
    expect([quantile([3, 1, 2, 4], 0.5), quantile([], 0.5)]).toEqual([3, 0]);
  });

  it('are logarithmic for deviations: the geometric mean has the colour of the middle', () => {
    const at = (mm: number) => plane({ offsetDeviation: mm / 1000 });
    const { of, legend } = planeColours('offset', [at(0.1), at(1), at(10)], THEMES.dark);
    expect(legend).toMatchObject({ minimum: 0.1, maximum: 10, unit: 'mm' });
    expect([of(at(0.1)), of(at(1)), of(at(10))]).toEqual([0, 0.5, 1].map(sequential));
  });

  it('hold for no planes and for planes that are all alike', () => {
    for (const planes of [[], [plane({ normalDeviation: 0 })], [plane(), plane()]]) {
      const { of, legend } = planeColours('normal', planes, THEMES.light);
      expect(legend?.kind).toBe('scale');
      expect(of(plane()).every(c => c >= 0 && c <= 255)).toBe(true);
    }
  });

  it('turn oklch into sRGB', () => {
    expect(oklch(1, 0, 0)).toEqual([255, 255, 255]);
    expect(oklch(0.62796, 0.25768, 29.234)).toEqual([255, 0, 0]); // red
  });

  it('have bars that fit', () => {
    // 160 pixels at most: 1.6 m, 16 m, 0.4 m
    expect([0.01, 0.1, 0.0025].map(scaleBarLength)).toEqual([1, 10, 0.2]);
  });
});

describe('QualityControl', () => {
  const run = (control: QualityControl, frames: number, time_ms: (level: number) => number) => {
    for (let i = 0; i < frames; ++i) control.frame(time_ms(LEVELS.indexOf(control.current)));
    return LEVELS.indexOf(control.current);
  };

  it('draws less until frames come often enough', () =>
    expect(run(new QualityControl(false), 200, level => 60 - 12 * level)).toBe(3));
  it('draws more where there is time', () => expect(run(new QualityControl(true), 400, () => 10)).toBe(0));
  it('does not draw less where that does not help', () => {
    const control = new QualityControl(false);
    const levels = Array.from({ length: 60 }, () => run(control, 6, () => 50));
    expect(levels.filter(level => level === 0).length).toBeGreaterThan(40);
  });
});

describe('packageFolder', () => {
  it('finds packages with and without a scope, and nothing for our own code', () => {
    expect(packageFolder('/p/node_modules/three/src/a.js?x')).toBe('/p/node_modules/three');
    expect(packageFolder('/p/node_modules/@s/n/a.js')).toBe('/p/node_modules/@s/n');
    expect(packageFolder('/p/src/a.ts')).toBeNull();
  });
});
