import { BufferAttribute, BufferGeometry, Points, PointsMaterial } from 'three';
import { type Rgb, sequential } from '../colour/scale';
import { type CellStore, spreadStride } from '../map/cells';

/** A cell's deviation of the normal at which its colour is the last of the scale. */
export const CELL_SCALE_DEG = 15;
const CELL_SIZE_M = 0.065;

/** Cells as points, coloured by the deviations of their normals. The first of them stand for all while the view moves. */
export class CellsLayer {
  readonly object = new Points(
    new BufferGeometry(),
    new PointsMaterial({ vertexColors: true, size: CELL_SIZE_M, sizeAttenuation: true }),
  );
  count = 0;

  constructor() {
    this.object.frustumCulled = false;
  }

  /** Draws at most so many. */
  set budget(cells: number) {
    this.object.geometry.setDrawRange(0, Math.min(cells, this.count));
  }

  show(cells: CellStore, accept: (planeId: number) => boolean, unknown: Rgb): void {
    let count = 0;
    cells.forEach((_values, _at, planeId) => {
      if (accept(planeId)) ++count;
    });
    const positions = new Float32Array(3 * count);
    const colours = new Uint8Array(4 * count).fill(255);
    const stride = spreadStride(count);
    const palette = Array.from({ length: 64 }, (_, i) => sequential(i / 63));
    const perRadian = 63 / ((CELL_SCALE_DEG * Math.PI) / 180);
    let place = 0;
    cells.forEach((values, at, planeId) => {
      if (!accept(planeId)) return;
      const deviation = values[at + 6]!;
      const colour = Number.isNaN(deviation) ? unknown : palette[Math.min(63, Math.round(deviation * perRadian))]!;
      for (let i = 0; i < 3; ++i) {
        positions[3 * place + i] = values[at + i]!;
        colours[4 * place + i] = colour[i]!;
      }
      place = (place + stride) % count;
    });
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute('position', new BufferAttribute(positions, 3));
    this.object.geometry.setAttribute('color', new BufferAttribute(colours, 4, true));
    this.count = count;
  }
}
