import { describe, expect, it } from 'vitest';
import { decodeCells, decodeScan } from '../../src/api/binary';
import { deltaAt, helloAt, pathAt, poseAt, statusAt } from '../../src/api/events';
import { planeAt, planesDocumentAt } from '../../src/api/planes';
import { planeJson } from './records';

const read = (given: Record<string, unknown>) => () => planeAt(planeJson(given), 'planes[3]');

describe('planeAt', () => {
  it('reads a plane', () => {
    const record = planeAt(planeJson({ coplanar: [4, 5] }), 'plane');
    expect(record).toMatchObject({ id: 1, class: 'floor', normalDeviation: 0.001, coplanarWith: [4, 5] });
  });

  it('opens rings that are closed', () => {
    const outer = [
      [0, 0, 0],
      [1, 0, 0],
      [1, 1, 0],
      [0, 0, 0],
    ]; // prettier-ignore
    expect(planeAt(planeJson({ polygons: [{ outer }] }), 'p').polygons[0]!.outer).toHaveLength(3);
  });

  it('takes a class that it does not know for another', () =>
    expect(planeAt(planeJson({ class: 'stairs' }), 'p').class).toBe('other'));

  it.each<[Record<string, unknown>, string]>([
    [{ id: -1 }, 'planes[3].id: no count'],
    [{ id: 2 ** 53 }, 'planes[3].id: no count'],
    [{ normal: [0, 0, 2] }, 'planes[3].normal: not of length 1'],
    [{ normal: [0, 0] }, 'planes[3].normal: not 3 finite numbers'],
    [{ d: null }, 'planes[3].d: no finite number'],
    [{ covariance: [1] }, 'planes[3].covariance: not 16 finite numbers'],
    [{ offsetDeviation: -1 }, 'planes[3].offsetDeviation: below zero'],
    [{ polygons: {} }, 'planes[3].polygons: no array'],
    [{ polygons: [{ outer: [[0, 0, 0]] }] }, 'planes[3].polygons[0].outer: fewer than 3 points'],
    [{ class: 7 }, 'planes[3].class: no text'],
  ])('names what is wrong with %j', (given, message) => expect(read(given)).toThrow(message));
});

describe('documents and events', () => {
  it('reads planes.json', () => {
    const text = { frame: 'world', epoch: 5, revision: 6, planes: [planeJson()] };
    expect(planesDocumentAt(text)).toMatchObject({ epoch: 5, revision: 6, planes: [{ id: 1 }] });
  });

  it('reads a delta', () => {
    const delta = {
      epoch: 1,
      revision: 9,
      since: 7,
      full: false,
      planes: [planeJson()],
      removed: [3],
      blocksChanged: 2,
    };
    expect(deltaAt(delta)).toMatchObject({ revision: 9, since: 7, full: false, removed: [3], blocksChanged: 2 });
  });

  it('reads hello and status', () => {
    expect(helloAt({ epoch: 1, revision: 2, frame: 'world', version: '1.0.0' }).frame).toBe('world');
    const status = { version: '1', planeCount: 3, cellCount: 4, scanRateHz: 5.5, lastScanUtime: 6, idleReason: '' };
    expect(statusAt(status)).toEqual(status);
  });

  it('makes orientations of length 1 and refuses what is none', () => {
    const pose = poseAt({ utime: 1, position: [1, 2, 3], orientation: [1.0002, 0, 0, 0] });
    expect(pose.orientation).toEqual([1, 0, 0, 0]);
    expect(() => poseAt({ utime: 1, position: [1, 2, 3], orientation: [0, 0, 0, 0] })).toThrow('length 0');
  });

  it('reads a path and names the pose that is wrong', () => {
    expect(pathAt({ poses: [[5, 1, 2, 3, 1, 0, 0, 0]] })[0]).toMatchObject({ utime: 5, position: [1, 2, 3] });
    expect(() => pathAt({ poses: [[5, 1, 2]] })).toThrow('path.poses[0]');
  });
});

/** Two blocks: one of two cells, one that is gone. */
function cellsBytes(): ArrayBuffer {
  const bytes = new ArrayBuffer(32 + 16 + 2 * 32 + 16);
  const view = new DataView(bytes);
  view.setUint32(0, 0x434d4c50, true);
  view.setUint32(4, 1, true);
  view.setBigUint64(8, 77n, true);
  view.setBigUint64(16, 12n, true);
  view.setUint32(28, 2, true);
  [-1, 0, 2, 2].forEach((x, i) => {
    view.setInt32(32 + 4 * i, x, true);
  });
  [0.5, 1.5, 2.5, 0, 0, 1, 0.25].forEach((x, i) => {
    view.setFloat32(48 + 4 * i, x, true);
  });
  view.setUint32(48 + 28, 9, true);
  view.setFloat32(80 + 24, Number.NaN, true);
  view.setInt32(112, 4, true);
  return bytes;
}

describe('decodeCells', () => {
  it('reads blocks', () => {
    const { epoch, revision, full, blocks } = decodeCells(cellsBytes());
    expect([epoch, revision, full]).toEqual([77, 12, false]);
    expect(blocks.map(block => block.key)).toEqual(['-1,0,2', '4,0,0']);
    expect([...blocks[0]!.values.slice(0, 7)]).toEqual([0.5, 1.5, 2.5, 0, 0, 1, 0.25]);
    expect([...blocks[0]!.planeIds]).toEqual([9, 0]);
    expect(blocks[0]!.values[13]).toBeNaN();
    expect(blocks[1]!.planeIds).toHaveLength(0);
  });

  it('refuses every cut', () => {
    const whole = cellsBytes();
    for (let length = 0; length < whole.byteLength; ++length) {
      expect(() => decodeCells(whole.slice(0, length)), `${length} bytes`).toThrow('cut short');
    }
  });

  it('refuses what is too long, of another kind, or newer', () => {
    const longer = new Uint8Array(132);
    longer.set(new Uint8Array(cellsBytes()));
    expect(() => decodeCells(longer.buffer)).toThrow('4 bytes too many');
    const other = cellsBytes();
    new DataView(other).setUint32(0, 1, true);
    expect(() => decodeCells(other)).toThrow('magic');
    const newer = cellsBytes();
    new DataView(newer).setUint32(4, 2, true);
    expect(() => decodeCells(newer)).toThrow('version 2');
  });

  it('takes no memory for a count that the bytes do not bear out', () => {
    const bytes = cellsBytes();
    new DataView(bytes).setUint32(44, 0xffffffff, true);
    expect(() => decodeCells(bytes)).toThrow('cut short in block 0 of 4294967295 cells');
  });
});

describe('decodeScan', () => {
  const bytes = new ArrayBuffer(24 + 12);
  const view = new DataView(bytes);
  view.setUint32(0, 0x534d4c50, true);
  view.setUint32(4, 1, true);
  view.setBigInt64(8, 123n, true);
  view.setUint32(16, 1, true);
  view.setFloat32(24, 1.5, true);

  it('reads points', () => expect(decodeScan(bytes)).toEqual({ utime: 123, points: new Float32Array([1.5, 0, 0]) }));
  it('refuses a count that does not fit', () =>
    expect(() => decodeScan(bytes.slice(0, 28))).toThrow('1 points do not fill 28 bytes'));
});
