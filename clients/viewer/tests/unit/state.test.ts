import { describe, expect, it } from 'vitest';
import type { CellsUpdate } from '../../src/api/binary';
import type { Delta } from '../../src/api/events';
import { LiveMap } from '../../src/live_map';
import { CellStore, spreadStride } from '../../src/map/cells';
import { accepts, NO_FILTER } from '../../src/map/filter';
import { applyDelta, EMPTY_MAP } from '../../src/map/state';
import { Selection } from '../../src/selection';
import { plane } from './records';

const delta = (given: Partial<Delta>): Delta => ({
  epoch: 1,
  revision: 1,
  since: 0,
  full: false,
  planes: [],
  removed: [],
  blocksChanged: 0,
  ...given,
});
const start = applyDelta(EMPTY_MAP, delta({ full: true, revision: 5, planes: [plane({ id: 1 }), plane({ id: 2 })] }));

describe('applyDelta', () => {
  it('changes, adds and removes, and leaves the state before as it was', () => {
    const after = applyDelta(start, delta({ since: 5, revision: 6, planes: [plane({ id: 3 })], removed: [1] }));
    expect([...after.planes.keys()]).toEqual([2, 3]);
    expect([...start.planes.keys()]).toEqual([1, 2]);
  });

  it('forgets all with a full one', () =>
    expect(applyDelta(start, delta({ full: true, epoch: 2, revision: 1 })).planes.size).toBe(0));

  it('takes one that begins before what is known', () =>
    expect(applyDelta(start, delta({ since: 3, revision: 7 })).revision).toBe(7));

  it('refuses one that leaves revisions out, and one of another map', () => {
    expect(() => applyDelta(start, delta({ since: 6, revision: 7 }))).toThrow('since revision 6; known is 5');
    expect(() => applyDelta(start, delta({ epoch: 2, since: 5 }))).toThrow('map 2, not 1');
  });
});

describe('LiveMap', () => {
  it('shows what it was when it was paused, and tells how far it is behind', () => {
    const map = new LiveMap();
    map.apply(delta({ full: true, revision: 5, planes: [plane({ id: 1 })] }));
    map.paused = true;
    map.apply(delta({ since: 5, revision: 8, removed: [1] }));
    expect([map.shown.planes.size, map.behind]).toEqual([1, 3]);
    map.paused = false;
    expect([map.shown.planes.size, map.behind]).toEqual([0, 0]);
  });

  it('is empty when the daemon greets with another map, and as it was with the same', () => {
    const map = new LiveMap();
    const hello = { epoch: 1, revision: 5, frame: 'world', version: '1' };
    expect(map.hello(hello)).toBe(false);
    map.apply(delta({ full: true, revision: 5, planes: [plane()] }));
    expect([map.hello(hello), map.shown.planes.size]).toEqual([false, 1]);
    expect([map.hello({ ...hello, epoch: 2 }), map.shown.planes.size]).toEqual([true, 0]);
  });

  it('knows when another map has begun', () => {
    const map = new LiveMap();
    expect(map.apply(delta({ full: true }))).toBe(false);
    expect(map.apply(delta({ full: true, epoch: 2 }))).toBe(true);
  });
});

describe('Selection', () => {
  const map = new LiveMap();
  map.apply(delta({ full: true, revision: 1, planes: [plane({ id: 1 }), plane({ id: 2 }), plane({ id: 3 })] }));

  it('measures between the first and the second choice, and the third begins anew', () => {
    const selection = new Selection(map);
    selection.choose(1, true);
    expect(selection.measurement).toBeNull();
    selection.choose(2, true);
    expect(selection.measurement).not.toBeNull();
    selection.choose(3, true);
    expect([selection.selected?.id, selection.second]).toEqual([3, null]);
  });

  it('tells of a plane that has left the map', () => {
    const selection = new Selection(map);
    selection.choose(9, false);
    expect([selection.selected, selection.goneId]).toEqual([null, 9]);
  });
});

describe('accepts', () => {
  it('looks at class, area and deviation', () => {
    const floor = plane({ class: 'floor', area: 2, normalDeviation: 0.01 });
    expect(accepts(NO_FILTER, floor)).toBe(true);
    expect(accepts({ ...NO_FILTER, hiddenClasses: new Set(['floor'] as const) }, floor)).toBe(false);
    expect(accepts({ ...NO_FILTER, leastArea_m2: 2.1 }, floor)).toBe(false);
    expect(accepts({ ...NO_FILTER, largestDeviation_rad: 0.009 }, floor)).toBe(false);
  });
});

describe('CellStore', () => {
  const block = (key: string, cells: number) => ({
    key,
    values: new Float32Array(7 * cells),
    planeIds: new Uint32Array(cells),
  });
  const update = (given: Partial<CellsUpdate>): CellsUpdate => ({
    epoch: 1,
    revision: 1,
    full: false,
    blocks: [],
    ...given,
  });

  it('replaces blocks and drops those without cells', () => {
    const store = new CellStore();
    store.apply(update({ full: true, blocks: [block('a', 3), block('b', 2)] }));
    store.apply(update({ revision: 2, blocks: [block('a', 1), block('b', 0)] }));
    let visited = 0;
    store.forEach(() => {
      ++visited;
    });
    expect([store.count, visited, store.revision]).toEqual([1, 1, 2]);
  });

  it('asks for all when a part of another map comes', () => {
    const store = new CellStore();
    store.apply(update({ full: true, blocks: [block('a', 3)] }));
    expect(store.apply(update({ epoch: 2, blocks: [block('b', 1)] }))).toBe(false);
    expect([store.count, store.revision]).toEqual([0, 0]);
  });
});

describe('spreadStride', () => {
  it.each([1, 2, 3, 10, 97, 1000, 50_000])('visits each of %d places once', count => {
    const stride = spreadStride(count);
    const places = new Set<number>();
    for (let i = 0, place = 0; i < count; ++i, place = (place + stride) % count) places.add(place);
    expect(places.size).toBe(count);
  });
});
