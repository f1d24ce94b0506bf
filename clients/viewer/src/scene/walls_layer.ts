import { BufferAttribute, BufferGeometry, Mesh, MeshBasicMaterial } from 'three';
import type { PlaneRecord } from '../api/planes';
import type { Rgb } from '../colour/scale';
import { type WallLine, wallLines } from '../map/wall_lines';

const THICKNESS_M = 0.07;
const CORNERS = [0, 1, 2, 0, 2, 3];

/** Upright planes as seen from above: strips at their upper edges, as a plan draws walls. */
export class WallsLayer {
  readonly object = new Mesh(new BufferGeometry(), new MeshBasicMaterial({ vertexColors: true }));
  lines: readonly WallLine[] = [];

  constructor() {
    this.object.frustumCulled = false;
    this.object.renderOrder = 5;
    this.object.visible = false;
  }

  show(planes: readonly PlaneRecord[], colourOf: (plane: PlaneRecord) => Rgb): void {
    this.lines = planes.flatMap(wallLines);
    const positions = new Float32Array(12 * this.lines.length);
    const colours = new Uint8Array(16 * this.lines.length).fill(255);
    const index = new Uint32Array(6 * this.lines.length);
    this.lines.forEach(({ plane, from, to }, i) => {
      const [nx, ny] = plane.normal;
      const behind = THICKNESS_M / Math.hypot(nx, ny); // the strip lies behind the surface that was seen
      const [bx, by] = [nx * behind, ny * behind];
      positions.set([from[0], from[1], from[2], to[0], to[1], to[2]], 12 * i);
      positions.set([to[0] - bx, to[1] - by, to[2], from[0] - bx, from[1] - by, from[2]], 12 * i + 6);
      for (let corner = 0; corner < 4; ++corner) colours.set(colourOf(plane), 16 * i + 4 * corner);
      const up = (to[0] - from[0]) * -by - (to[1] - from[1]) * -bx > 0; // which way round faces up
      CORNERS.forEach((corner, k) => {
        index[6 * i + (up ? k : 5 - k)] = 4 * i + corner;
      });
    });
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute('position', new BufferAttribute(positions, 3));
    this.object.geometry.setAttribute('color', new BufferAttribute(colours, 4, true));
    this.object.geometry.setIndex(new BufferAttribute(index, 1));
  }
}
