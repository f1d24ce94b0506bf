import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, LineSegments, Quaternion } from 'three';
import type { Pose } from '../api/events';
import type { Rgb } from '../colour/scale';
import { setColour } from './colours';

const DEPTH_M = 0.6;
const HALF_WIDTH = Math.tan((57 / 2) * (Math.PI / 180)); // a Kinect's view: 57 by 43 degrees
const HALF_HEIGHT = Math.tan((43 / 2) * (Math.PI / 180));
const MOST_POSES = 20000;

/** Edges of the view in sensor coordinates: x right, y down, z forward. A tick above its upper edge shows what is up. */
function frustumEdges(): Float32Array {
  const corner = (x: number, y: number) => [x * HALF_WIDTH * DEPTH_M, y * HALF_HEIGHT * DEPTH_M, DEPTH_M];
  const [a, b, c, d] = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)] as [
    number[],
    number[],
    number[],
    number[],
  ];
  const apex = [0, 0, 0];
  const tick = [corner(-0.25, -1.1), corner(0, -1.4), corner(0, -1.4), corner(0.25, -1.1)];
  return new Float32Array([apex, a, apex, b, apex, c, apex, d, a, b, b, c, c, d, d, a, ...tick].flat());
}

/** Where the sensor is, and where it has been. */
export class RobotLayer {
  readonly object = new Group();
  private readonly line = new LineBasicMaterial();
  private readonly pathLine = new LineBasicMaterial({ transparent: true, opacity: 0.75 });
  private readonly frustum = new LineSegments(new BufferGeometry(), this.line);
  private readonly path = new Line(new BufferGeometry(), this.pathLine);
  private positions = new Float32Array(0);
  private count = 0;
  private lastUtime = Number.NEGATIVE_INFINITY;

  constructor() {
    this.frustum.geometry.setAttribute('position', new BufferAttribute(frustumEdges(), 3));
    this.frustum.visible = false;
    for (const part of [this.frustum, this.path]) part.frustumCulled = false;
    this.object.add(this.frustum, this.path);
  }

  setColours(robot: Rgb, path: Rgb): void {
    setColour(this.line.color, robot);
    setColour(this.pathLine.color, path);
  }

  showPath(poses: readonly Pose[]): void {
    this.count = 0;
    for (const pose of poses) this.append(pose);
    this.lastUtime = poses.at(-1)?.utime ?? Number.NEGATIVE_INFINITY;
    this.upload();
  }

  /** Returns whether anything looks different now. */
  showPose(pose: Pose): boolean {
    const [w, x, y, z] = pose.orientation;
    const orientation = new Quaternion(x, y, z, w);
    const same =
      this.frustum.visible &&
      pose.position.every((value, i) => value === this.frustum.position.getComponent(i)) &&
      orientation.equals(this.frustum.quaternion);
    if (same) return false;
    this.frustum.visible = true;
    this.frustum.position.set(...pose.position);
    this.frustum.quaternion.copy(orientation);
    if (pose.utime > this.lastUtime) {
      this.append(pose);
      this.lastUtime = pose.utime;
      this.upload();
    }
    return true;
  }

  private append(pose: Pose): void {
    if (this.count === MOST_POSES) {
      this.positions.copyWithin(0, 3 * (MOST_POSES / 4), 3 * MOST_POSES); // the oldest quarter goes
      this.count -= MOST_POSES / 4;
    }
    if (3 * (this.count + 1) > this.positions.length) {
      const larger = new Float32Array(Math.max(3 * 512, 2 * this.positions.length));
      larger.set(this.positions);
      this.positions = larger;
    }
    this.positions.set(pose.position, 3 * this.count++);
  }

  private upload(): void {
    const known = this.path.geometry.getAttribute('position');
    if (known?.array === this.positions) {
      known.needsUpdate = true;
    } else {
      this.path.geometry.dispose();
      this.path.geometry.setAttribute('position', new BufferAttribute(this.positions, 3));
    }
    this.path.geometry.setDrawRange(0, this.count);
  }
}
