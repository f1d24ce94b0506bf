import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
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

/** One plane marked: tinted from both sides, and its outline seen through everything. */
export class HighlightLayer {
  readonly object = new Group();
  private readonly tint = new MeshBasicMaterial({
    transparent: true,
    opacity: 0.38,
    side: DoubleSide,
    depthWrite: false,
  });
  private readonly line = new LineBasicMaterial({ depthTest: false, transparent: true });

  show(plane: PlaneRecord | null, colour: Rgb): void {
    for (const part of this.object.children) (part as Mesh).geometry.dispose();
    this.object.clear();
    if (!plane) return;
    setColour(this.tint.color, colour);
    setColour(this.line.color, colour);
    const { positions, triangles, segments } = tessellate(plane);
    const shared = new BufferAttribute(positions, 3);
    const mesh = new Mesh(new BufferGeometry(), this.tint);
    const outline = new LineSegments(new BufferGeometry(), this.line);
    for (const [part, index] of [
      [mesh, triangles],
      [outline, segments],
    ] as const) {
      part.geometry.setAttribute('position', shared);
      part.geometry.setIndex(new BufferAttribute(index, 1));
    }
    outline.renderOrder = 10;
    this.object.add(mesh, outline);
  }
}
