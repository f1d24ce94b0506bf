import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial } from 'three';
import type { Vec3 } from '../api/check';
import type { Rgb } from '../colour/scale';
import { setColour } from './colours';

/** The distance that is measured: a line with its two ends, seen through everything. */
export class MeasureLayer {
  readonly object = new Group();
  private readonly line = new LineBasicMaterial({ depthTest: false, transparent: true });
  private readonly ends = new PointsMaterial({ size: 7, sizeAttenuation: false, depthTest: false, transparent: true });
  private readonly geometry = new BufferGeometry();

  constructor() {
    this.geometry.setAttribute('position', new BufferAttribute(new Float32Array(6), 3));
    for (const part of [new LineSegments(this.geometry, this.line), new Points(this.geometry, this.ends)]) {
      part.frustumCulled = false;
      part.renderOrder = 20;
      this.object.add(part);
    }
    this.object.visible = false;
  }

  setColour(colour: Rgb): void {
    setColour(this.line.color, colour);
    setColour(this.ends.color, colour);
  }

  show(ends: readonly [Vec3, Vec3] | null): void {
    this.object.visible = ends !== null;
    if (!ends) return;
    const positions = this.geometry.getAttribute('position') as BufferAttribute;
    positions.setXYZ(0, ...ends[0]).setXYZ(1, ...ends[1]);
    positions.needsUpdate = true;
  }
}
