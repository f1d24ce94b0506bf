import { DecodeError } from './check';

const CELLS_MAGIC = 0x434d4c50; // "PLMC"
const SCAN_MAGIC = 0x534d4c50; // "PLMS"
const VERSION = 1;

/** Numbers of a cell in `CellBlock.values`: centre (m), normal, its deviation (rad; NaN: no normal). */
export const CELL_FLOATS = 7;
const CELL_BYTES = 4 * (CELL_FLOATS + 1);
const CELLS_HEADER_BYTES = 32;
const BLOCK_HEADER_BYTES = 16;
const SCAN_HEADER_BYTES = 24;

/** The dense cells of one block of 8x8x8. */
export interface CellBlock {
  readonly key: string; // its index, "x,y,z"
  readonly values: Float32Array; // CELL_FLOATS a cell
  readonly planeIds: Uint32Array; // 0: of no plane
}

/** Blocks that replace those of the same key; one without cells is gone. `full`: all that is not here is gone. */
export interface CellsUpdate {
  readonly epoch: number;
  readonly revision: number;
  readonly full: boolean;
  readonly blocks: readonly CellBlock[];
}

export interface Scan {
  readonly utime: number; // µs
  readonly points: Float32Array; // x, y, z in the map frame, m
}

function safeNumber(value: bigint, where: string): number {
  if (value > BigInt(Number.MAX_SAFE_INTEGER) || value < 0n)
    throw new DecodeError(`${where}: ${value} is out of range`);
  return Number(value);
}

function header(bytes: ArrayBuffer, least: number, magic: number, what: string): DataView {
  const view = new DataView(bytes);
  if (bytes.byteLength < least) throw new DecodeError(`${what}: cut short in the header (${bytes.byteLength} bytes)`);
  if (view.getUint32(0, true) !== magic) throw new DecodeError(`${what}: wrong magic number`);
  const version = view.getUint32(4, true);
  if (version !== VERSION) throw new DecodeError(`${what}: version ${version}; this page knows ${VERSION}. Reload it.`);
  return view;
}

function blockAt(view: DataView, offset: number, count: number): CellBlock {
  const [x, y, z] = [0, 4, 8].map(i => view.getInt32(offset + i, true));
  const values = new Float32Array(count * CELL_FLOATS);
  const planeIds = new Uint32Array(count);
  let at = offset + BLOCK_HEADER_BYTES;
  for (let cell = 0; cell < count; ++cell, at += CELL_BYTES) {
    for (let i = 0; i < CELL_FLOATS; ++i) values[cell * CELL_FLOATS + i] = view.getFloat32(at + 4 * i, true);
    planeIds[cell] = view.getUint32(at + 4 * CELL_FLOATS, true);
  }
  return { key: `${x},${y},${z}`, values, planeIds };
}

/** Of `/api/v1/cells`. Counts are checked against the length before memory is taken for them. @throws DecodeError */
export function decodeCells(bytes: ArrayBuffer): CellsUpdate {
  const view = header(bytes, CELLS_HEADER_BYTES, CELLS_MAGIC, 'cells');
  const blockCount = view.getUint32(28, true);
  const blocks: CellBlock[] = [];
  let offset = CELLS_HEADER_BYTES;
  for (let i = 0; i < blockCount; ++i) {
    if (offset + BLOCK_HEADER_BYTES > bytes.byteLength) throw new DecodeError(`cells: cut short before block ${i}`);
    const count = view.getUint32(offset + 12, true);
    const end = offset + BLOCK_HEADER_BYTES + count * CELL_BYTES;
    if (end > bytes.byteLength) throw new DecodeError(`cells: cut short in block ${i} of ${count} cells`);
    blocks.push(blockAt(view, offset, count));
    offset = end;
  }
  if (offset !== bytes.byteLength) throw new DecodeError(`cells: ${bytes.byteLength - offset} bytes too many`);
  return {
    epoch: safeNumber(view.getBigUint64(8, true), 'cells: epoch'),
    revision: safeNumber(view.getBigUint64(16, true), 'cells: revision'),
    full: view.getUint32(24, true) === 1,
    blocks,
  };
}

/** Of `/api/v1/scan`. @throws DecodeError */
export function decodeScan(bytes: ArrayBuffer): Scan {
  const view = header(bytes, SCAN_HEADER_BYTES, SCAN_MAGIC, 'scan');
  const count = view.getUint32(16, true);
  if (SCAN_HEADER_BYTES + 12 * count !== bytes.byteLength) {
    throw new DecodeError(`scan: ${count} points do not fill ${bytes.byteLength} bytes`);
  }
  const points = new Float32Array(3 * count);
  for (let i = 0; i < points.length; ++i) points[i] = view.getFloat32(SCAN_HEADER_BYTES + 4 * i, true);
  return { utime: Number(view.getBigInt64(8, true)), points };
}
