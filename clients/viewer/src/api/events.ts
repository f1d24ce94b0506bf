import {
  arrayAt,
  countAt,
  numberAt,
  objectAt,
  type Quaternion,
  quaternionAt,
  stringAt,
  type Vec3,
  vec3At,
} from './check';
import { type PlaneRecord, planesAt } from './planes';

/** First on each connection. */
export interface Hello {
  readonly epoch: number;
  readonly revision: number;
  readonly frame: string;
  readonly version: string;
}

/** What has changed between the revisions `since` and `revision`; `full`: all there is, what was known before is void. */
export interface Delta {
  readonly epoch: number;
  readonly revision: number;
  readonly since: number;
  readonly full: boolean;
  readonly planes: readonly PlaneRecord[];
  readonly removed: readonly number[];
  readonly blocksChanged: number;
}

/** Of the sensor in the map frame: x right, y down, z forward. */
export interface Pose {
  readonly utime: number; // µs
  readonly position: Vec3; // m
  readonly orientation: Quaternion; // takes sensor coordinates to map coordinates
}

export interface Status {
  readonly version: string;
  readonly planeCount: number;
  readonly cellCount: number;
  readonly scanRateHz: number;
  readonly lastScanUtime: number; // µs
  readonly idleReason: string; // empty: scans are being mapped
}

export function helloAt(value: unknown): Hello {
  const object = objectAt(value, 'hello');
  return {
    epoch: countAt(object.epoch, 'hello.epoch'),
    revision: countAt(object.revision, 'hello.revision'),
    frame: stringAt(object.frame, 'hello.frame'),
    version: stringAt(object.version, 'hello.version'),
  };
}

export function deltaAt(value: unknown): Delta {
  const object = objectAt(value, 'delta');
  return {
    epoch: countAt(object.epoch, 'delta.epoch'),
    revision: countAt(object.revision, 'delta.revision'),
    since: countAt(object.since ?? 0, 'delta.since'),
    full: object.full === true,
    planes: planesAt(object.planes, 'delta.planes'),
    removed: arrayAt(object.removed, 'delta.removed').map((id, i) => countAt(id, `delta.removed[${i}]`)),
    blocksChanged: countAt(object.blocksChanged ?? 0, 'delta.blocksChanged'),
  };
}

export function poseAt(value: unknown): Pose {
  const object = objectAt(value, 'pose');
  return {
    utime: numberAt(object.utime, 'pose.utime'),
    position: vec3At(object.position, 'pose.position'),
    orientation: quaternionAt(object.orientation, 'pose.orientation'),
  };
}

export function statusAt(value: unknown): Status {
  const object = objectAt(value, 'status');
  return {
    version: stringAt(object.version, 'status.version'),
    planeCount: countAt(object.planeCount, 'status.planeCount'),
    cellCount: countAt(object.cellCount, 'status.cellCount'),
    scanRateHz: numberAt(object.scanRateHz, 'status.scanRateHz'),
    lastScanUtime: numberAt(object.lastScanUtime ?? 0, 'status.lastScanUtime'),
    idleReason: stringAt(object.idleReason ?? '', 'status.idleReason'),
  };
}

/** Of `/api/v1/path`, oldest first. */
export function pathAt(value: unknown): Pose[] {
  return arrayAt(objectAt(value, 'path').poses, 'path.poses').map((row, i) => {
    const where = `path.poses[${i}]`;
    const [utime, x, y, z, w, qx, qy, qz] = arrayAt(row, where);
    return {
      utime: numberAt(utime, `${where}[0]`),
      position: vec3At([x, y, z], where),
      orientation: quaternionAt([w, qx, qy, qz], where),
    };
  });
}
