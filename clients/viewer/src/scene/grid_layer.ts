import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';
import type { Rgb } from '../colour/scale';
import type { Bounds } from '../map/bounds';
import { setColour } from './colours';

const MOST_LINES = 120;

/** Lines of a horizontal grid below the map: one a metre, fewer below large maps. */
export class GridLayer {
  private readonly material = new LineBasicMaterial();
  readonly object = new LineSegments(new BufferGeometry(), this.material);
  private shown = '';

  constructor() {
    this.object.frustumCulled = false;
    this.object.renderOrder = -1;
  }

  setColour(colour: Rgb): void {
    setColour(this.material.color, colour);
  }

  /** Below the box, a step beyond it on each side. */
  show({ min, max }: Bounds): void {
    const extent = Math.max(max[0] - min[0], max[1] - min[1]);
    const step = [1, 2, 5, 10, 20, 50, 100].find(s => extent / s < MOST_LINES / 2) ?? 1000;
    const [x0, y0] = [Math.floor(min[0] / step) - 1, Math.floor(min[1] / step) - 1];
    const [x1, y1] = [Math.ceil(max[0] / step) + 1, Math.ceil(max[1] / step) + 1];
    const z = Math.floor(min[2] * 10) / 10 - 0.02;
    const key = [x0, y0, x1, y1, z, step].join();
    if (key === this.shown) return;
    this.shown = key;
    const points: number[] = [];
    for (let x = x0; x <= x1; ++x) points.push(x * step, y0 * step, z, x * step, y1 * step, z);
    for (let y = y0; y <= y1; ++y) points.push(x0 * step, y * step, z, x1 * step, y * step, z);
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
  }
}
