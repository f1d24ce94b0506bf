import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { deflateSync } from 'node:zlib';

// A camera of 640 x 480 pixels before a wall of facets that lean to different sides, so that no two neighbours are one plane.
const [WIDTH, HEIGHT, FOCAL_PX, CENTRE_X, CENTRE_Y] = [640, 480, 585, 320, 240];
const [COLUMNS, ROWS] = [9, 7];
const DEPTH_M = 3;
const STEP_M = 0.25; // every other facet is farther away
const SLOPE = 0.35;
const BORDER_PX = 2; // without depth, about each facet
const SPACING_M = 4.5; // between stations
const ROW_LENGTH = 10; // stations side by side, then the next row above

export const FACETS = COLUMNS * ROWS; // planes that a station sees
export const INTRINSICS = [FOCAL_PX, FOCAL_PX, CENTRE_X, CENTRE_Y].join(',');

/** A folder in the layout of 7-Scenes: at each of the stations so many frames of such a wall. `remove` takes it away. */
export function facetFolder(first: number, stations: number, frames: number): { folder: string; remove: () => void } {
  const folder = mkdtempSync(join(tmpdir(), 'planemap-facets-'));
  mkdirSync(folder, { recursive: true });
  const picture = png(facetDepth());
  for (let frame = 0; frame < stations * frames; ++frame) {
    const station = first + Math.floor(frame / frames);
    const name = join(folder, `frame-${String(frame).padStart(6, '0')}`);
    writeFileSync(`${name}.depth.png`, picture);
    writeFileSync(
      `${name}.pose.txt`,
      poseText(SPACING_M * (station % ROW_LENGTH), SPACING_M * Math.floor(station / ROW_LENGTH)),
    );
  }
  return { folder, remove: () => rmSync(folder, { recursive: true }) };
}

/** Looks along +y of a world whose z is up. */
function poseText(x: number, z: number): string {
  return `1 0 0 ${x}\n0 0 1 0\n0 -1 0 ${z}\n0 0 0 1\n`;
}

/** Millimetres, row by row; 0: nothing. */
function facetDepth(): Uint16Array {
  const depth = new Uint16Array(WIDTH * HEIGHT);
  for (let v = 0; v < HEIGHT; ++v) {
    for (let u = 0; u < WIDTH; ++u) depth[v * WIDTH + u] = facetDepthAt(u, v);
  }
  return depth;
}

function facetDepthAt(u: number, v: number): number {
  const [column, row] = [Math.floor((u * COLUMNS) / WIDTH), Math.floor((v * ROWS) / HEIGHT)];
  const [du, dv] = [u - ((column + 0.5) * WIDTH) / COLUMNS, v - ((row + 0.5) * HEIGHT) / ROWS];
  if (Math.abs(du) > WIDTH / COLUMNS / 2 - BORDER_PX || Math.abs(dv) > HEIGHT / ROWS / 2 - BORDER_PX) return 0;
  const centre_m = DEPTH_M + ((column + row) % 2) * STEP_M;
  const lean = (((column % 3) - 1) * SLOPE * du + ((row % 3) - 1) * SLOPE * dv) / FOCAL_PX;
  return Math.round((1000 * centre_m) / (1 + lean));
}

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  let crc = n;
  for (let bit = 0; bit < 8; ++bit) crc = crc & 1 ? 0xedb88320 ^ (crc >>> 1) : crc >>> 1;
  return crc >>> 0;
});

function chunk(type: string, content: Buffer): Buffer {
  const whole = Buffer.alloc(12 + content.length);
  whole.writeUInt32BE(content.length, 0);
  whole.write(type, 4, 'latin1');
  content.copy(whole, 8);
  let crc = 0xffffffff;
  for (const byte of whole.subarray(4, 8 + content.length)) crc = CRC_TABLE[(crc ^ byte) & 255]! ^ (crc >>> 8);
  whole.writeUInt32BE(~crc >>> 0, 8 + content.length);
  return whole;
}

/** Grey of 16 bits. */
function png(values: Uint16Array): Buffer {
  const rows = Buffer.alloc(HEIGHT * (1 + 2 * WIDTH));
  values.forEach((value, i) => {
    const row = Math.floor(i / WIDTH);
    rows.writeUInt16BE(value, row * (1 + 2 * WIDTH) + 1 + 2 * (i % WIDTH));
  });
  const header = Buffer.alloc(13);
  header.writeUInt32BE(WIDTH, 0);
  header.writeUInt32BE(HEIGHT, 4);
  header[8] = 16; // bits; grey, deflate, no filter, not interlaced are 0
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  const pixels = chunk('IDAT', deflateSync(rows, { level: 1 }));
  return Buffer.concat([signature, chunk('IHDR', header), pixels, chunk('IEND', Buffer.alloc(0))]);
}
