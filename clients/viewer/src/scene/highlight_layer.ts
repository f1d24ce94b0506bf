import {
  BackSide,
  BufferAttribute,
  BufferGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
} from 'three';
import type { PlaneRecord } from '../api/planes';
import type { Rgb } from '../colour/scale';
import { tessellate } from '../map/tessellate';
import { setColour } from './colours';

/** One plane marked: tinted, from behind so faintly that one still sees through, and its outline seen through everything. */
export class HighlightLayer {
  readonly object = new Group();
  private readonly front = new MeshBasicMaterial({ transparent: true, opacity: 0.4, depthWrite: false });
  private readonly back = new MeshBasicMaterial({
    transparent: true,
    opacity: 0.09,
    depthWrite: false,
    side: BackSide,
  });
  private readonly line = new LineBasicMaterial({ depthTest: false, transparent: true });

  show(plane: PlaneRecord | null, colour: Rgb): void {
    for (const part of this.object.children) (part as Mesh).geometry.dispose();
    this.object.clear();
    if (!plane) return;
    for (const material of [this.front, this.back, this.line]) setColour(material.color, colour);
    const { positions, triangles, segments } = tessellate(plane);
    const shared = new BufferAttribute(positions, 3);
    const part = (index: Uint32Array) =>
      new BufferGeometry().setAttribute('position', shared).setIndex(new BufferAttribute(index, 1));
    const surface = part(triangles);
    const outline = new LineSegments(part(segments), this.line);
    outline.renderOrder = 10;
    this.object.add(new Mesh(surface, this.front), new Mesh(surface, this.back), outline);
  }
}
