import {
  BufferAttribute,
  BufferGeometry,
  FrontSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
} from 'three';
import type { PlaneRecord } from '../api/planes';
import { mix, type Rgb } from '../colour/scale';
import { tessellate } from '../map/tessellate';
import { setColour } from './colours';

const NONE = new Uint32Array(0);

/** Light from above and a little from the side, so that walls of one colour are told apart. */
function shade(colour: Rgb, plane: PlaneRecord): Rgb {
  const [x, y, z] = plane.normal;
  const light = 0.9 + 0.06 * z + 0.04 * x - 0.03 * y;
  return mix([0, 0, 0], colour, Math.min(1, light));
}

/**
 * All planes as one mesh and all their outlines as another: two draw calls. Planes are seen from the side from which the sensor
 * saw them: through the backs of ceilings and walls one looks into the rooms, and only their outlines are left.
 */
export class PlanesLayer {
  readonly object = new Group();
  private readonly surface = new MeshBasicMaterial({
    vertexColors: true,
    side: FrontSide,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
  private readonly line = new LineBasicMaterial({ transparent: true });
  private readonly mesh = new Mesh(new BufferGeometry(), this.surface);
  private readonly outlines = new LineSegments(new BufferGeometry(), this.line);
  private planes: readonly PlaneRecord[] = [];

  constructor() {
    this.object.add(this.mesh, this.outlines);
    for (const part of [this.mesh, this.outlines]) part.frustumCulled = false;
  }

  set surfacesVisible(visible: boolean) {
    this.mesh.visible = visible;
  }

  set outlinesVisible(visible: boolean) {
    this.outlines.visible = visible;
  }

  setOutlineColour(colour: Rgb, opacity: number): void {
    setColour(this.line.color, colour);
    this.line.opacity = opacity;
  }

  /** @param outlined whether a plane's outline is drawn, too */
  show(
    planes: readonly PlaneRecord[],
    colourOf: (plane: PlaneRecord) => Rgb,
    outlined: (plane: PlaneRecord) => boolean,
  ): void {
    this.planes = planes;
    const parts = planes.map(plane => {
      const { positions, triangles, segments } = tessellate(plane);
      return { positions, triangles, segments: outlined(plane) ? segments : NONE };
    });
    const total = (count: (part: (typeof parts)[number]) => number) =>
      parts.reduce((sum, part) => sum + count(part), 0);
    const positions = new Float32Array(total(part => part.positions.length));
    const triangles = new Uint32Array(total(part => part.triangles.length));
    const segments = new Uint32Array(total(part => part.segments.length));
    let [p, t, s] = [0, 0, 0];
    for (const part of parts) {
      const first = p / 3;
      positions.set(part.positions, p);
      for (const vertex of part.triangles) triangles[t++] = first + vertex;
      for (const vertex of part.segments) segments[s++] = first + vertex;
      p += part.positions.length;
    }
    const shared = new BufferAttribute(positions, 3);
    replaceGeometry(this.mesh, shared, triangles);
    replaceGeometry(this.outlines, shared, segments);
    this.recolour(colourOf);
  }

  recolour(colourOf: (plane: PlaneRecord) => Rgb): void {
    const vertices = this.mesh.geometry.getAttribute('position').count;
    const colours = new Uint8Array(4 * vertices).fill(255); // four bytes: aligned for the graphics processor
    let vertex = 0;
    for (const plane of this.planes) {
      const colour = shade(colourOf(plane), plane);
      const end = vertex + tessellate(plane).positions.length / 3;
      for (; vertex < end; ++vertex) colours.set(colour, 4 * vertex);
    }
    this.mesh.geometry.setAttribute('color', new BufferAttribute(colours, 4, true));
  }
}

function replaceGeometry(part: Mesh | LineSegments, positions: BufferAttribute, index: Uint32Array): void {
  part.geometry.dispose();
  part.geometry = new BufferGeometry();
  part.geometry.setAttribute('position', positions);
  part.geometry.setIndex(new BufferAttribute(index, 1));
}
