import { Color, ConeGeometry, DoubleSide, InstancedMesh, Matrix4, MeshBasicMaterial, Quaternion, Vector3 } from 'three';
import { sequential } from '../colour/scale';
import type { CellStore } from '../map/cells';
import { CELL_SCALE_DEG } from './cells_layer';
import { setColour } from './colours';

const MOST_CONES = 1500;
const SIDE_M = 0.14; // from the apex to the rim
/** Cones open by so many times the standard deviation: a degree could not be seen. The page says so. */
export const CONE_FACTOR = 5;
const WIDEST_RAD = (85 * Math.PI) / 180;

/** Open cone of height 1 and radius 1, its apex at the origin, opening along +z. */
function unitCone(): ConeGeometry {
  const cone = new ConeGeometry(1, 1, 14, 1, true);
  cone.translate(0, -0.5, 0);
  cone.rotateX(-Math.PI / 2);
  return cone;
}

/** For each cell of one plane a cone about its normal whose half angle is a multiple of the normal's standard deviation. */
export class ConesLayer {
  readonly object = new InstancedMesh(
    unitCone(),
    new MeshBasicMaterial({ side: DoubleSide, transparent: true, opacity: 0.75, depthWrite: false }),
    MOST_CONES,
  );

  constructor() {
    this.object.frustumCulled = false;
    this.object.count = 0;
    this.object.setColorAt(0, new Color()); // makes room for the colours
  }

  /** Cones of a plane's cells, of every so many'th where they are too many; none of 0. Returns how many cells have a normal. */
  show(cells: CellStore, planeId: number): number {
    const found: Float32Array[] = [];
    if (planeId !== 0) {
      cells.forEach((values, at, id) => {
        if (id === planeId && !Number.isNaN(values[at + 6]!)) found.push(values.subarray(at, at + 7));
      });
    }
    const every = Math.ceil(found.length / MOST_CONES);
    const chosen = found.filter((_, i) => i % every === 0);
    for (const [i, values] of chosen.entries()) this.place(i, values);
    this.object.count = chosen.length;
    this.object.instanceMatrix.needsUpdate = true;
    if (this.object.instanceColor) this.object.instanceColor.needsUpdate = true;
    return found.length;
  }

  private place(i: number, [x, y, z, nx, ny, nz, deviation]: Float32Array): void {
    const rotation = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(nx, ny, nz));
    const half = Math.min(CONE_FACTOR * deviation!, WIDEST_RAD);
    const radius = SIDE_M * Math.sin(half);
    const size = new Vector3(radius, radius, SIDE_M * Math.cos(half));
    const colour = new Color();
    setColour(colour, sequential(deviation! / ((CELL_SCALE_DEG * Math.PI) / 180)));
    this.object.setMatrixAt(i, new Matrix4().compose(new Vector3(x, y, z), rotation, size));
    this.object.setColorAt(i, colour);
  }
}
