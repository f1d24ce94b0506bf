import { BufferAttribute, BufferGeometry, Points, PointsMaterial } from 'three';
import type { Rgb } from '../colour/scale';
import { setColour } from './colours';

/** The points of the last scan. */
export class ScanLayer {
  private readonly material = new PointsMaterial({ size: 2, sizeAttenuation: false });
  readonly object = new Points(new BufferGeometry(), this.material);

  constructor() {
    this.object.frustumCulled = false;
    this.show(new Float32Array(0));
  }

  setColour(colour: Rgb): void {
    setColour(this.material.color, colour);
  }

  show(points: Float32Array): void {
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute('position', new BufferAttribute(points, 3));
  }
}
