import { arrayAt, countAt, DecodeError, numberAt, numbersAt, objectAt, stringAt, type Vec3, vec3At } from './check';

export const PLANE_CLASSES = ['floor', 'ceiling', 'wall', 'table', 'slope', 'other'] as const;
export type PlaneClass = (typeof PLANE_CLASSES)[number];

/** A polygon in the map frame, metres. The outer ring runs counter-clockwise seen from the normal's side; none is closed. */
export interface Polygon {
  readonly outer: readonly Vec3[];
  readonly holes: readonly (readonly Vec3[])[];
}

/** A plane {x : normal · x + d = 0} of the map, as the daemon tells of it. */
export interface PlaneRecord {
  readonly id: number;
  readonly normal: Vec3; // length 1, towards the side from which the plane was seen
  readonly d: number; // m
  readonly covariance: readonly number[]; // 4x4, row-major, of (nx, ny, nz, d)
  readonly centroid: Vec3; // m
  readonly area: number; // m²
  readonly polygons: readonly Polygon[];
  readonly cellCount: number;
  readonly pointCount: number;
  readonly class: PlaneClass;
  readonly quality: number;
  readonly firstSeenUtime: number; // µs
  readonly lastSeenUtime: number; // µs
  readonly normalDeviation: number; // rad
  readonly offsetDeviation: number; // m, of the offset at the centroid
  readonly coplanarWith: readonly number[];
}

/** What `/api/v1/planes` answers. */
export interface PlanesDocument {
  readonly frame: string;
  readonly epoch: number;
  readonly revision: number;
  readonly planes: readonly PlaneRecord[];
}

function ringAt(value: unknown, where: string): Vec3[] {
  const ring = arrayAt(value, where).map((point, i) => vec3At(point, `${where}[${i}]`));
  const [first, last] = [ring[0], ring.at(-1)];
  if (first && last && ring.length > 1 && first.every((x, i) => x === last[i])) ring.pop();
  if (ring.length < 3) throw new DecodeError(`${where}: fewer than 3 points`);
  return ring;
}

function polygonAt(value: unknown, where: string): Polygon {
  const object = objectAt(value, where);
  return {
    outer: ringAt(object.outer, `${where}.outer`),
    holes: arrayAt(object.holes ?? [], `${where}.holes`).map((hole, i) => ringAt(hole, `${where}.holes[${i}]`)),
  };
}

function unitVectorAt(value: unknown, where: string): Vec3 {
  const vector = vec3At(value, where);
  if (Math.abs(Math.hypot(...vector) - 1) > 1e-3) throw new DecodeError(`${where}: not of length 1`);
  return vector;
}

function deviationAt(value: unknown, where: string): number {
  const deviation = numberAt(value, where);
  if (deviation < 0) throw new DecodeError(`${where}: below zero`);
  return deviation;
}

function coplanarAt(value: unknown, where: string): number[] {
  if (value === undefined || value === null) return [];
  return (Array.isArray(value) ? value : [value]).map((id, i) => countAt(id, `${where}[${i}]`));
}

/** @throws DecodeError that names the field */
export function planeAt(value: unknown, where: string): PlaneRecord {
  const object = objectAt(value, where);
  const planeClass = stringAt(object.class, `${where}.class`);
  return {
    id: countAt(object.id, `${where}.id`),
    normal: unitVectorAt(object.normal, `${where}.normal`),
    d: numberAt(object.d, `${where}.d`),
    covariance: numbersAt(object.covariance, 16, `${where}.covariance`),
    centroid: vec3At(object.centroid, `${where}.centroid`),
    area: numberAt(object.area, `${where}.area`),
    polygons: arrayAt(object.polygons, `${where}.polygons`).map((p, i) => polygonAt(p, `${where}.polygons[${i}]`)),
    cellCount: countAt(object.cellCount, `${where}.cellCount`),
    pointCount: numberAt(object.pointCount, `${where}.pointCount`),
    class: PLANE_CLASSES.find(known => known === planeClass) ?? 'other', // a class of a newer daemon
    quality: numberAt(object.quality, `${where}.quality`),
    firstSeenUtime: numberAt(object.firstSeenUtime, `${where}.firstSeenUtime`),
    lastSeenUtime: numberAt(object.lastSeenUtime, `${where}.lastSeenUtime`),
    normalDeviation: deviationAt(object.normalDeviation, `${where}.normalDeviation`),
    offsetDeviation: deviationAt(object.offsetDeviation, `${where}.offsetDeviation`),
    coplanarWith: coplanarAt(object.coplanarWith ?? object.coplanar, `${where}.coplanarWith`),
  };
}

/** @throws DecodeError that names the field */
export function planesAt(value: unknown, where: string): PlaneRecord[] {
  return arrayAt(value, where).map((plane, i) => planeAt(plane, `${where}[${i}]`));
}

/** @throws DecodeError that names the field */
export function planesDocumentAt(value: unknown): PlanesDocument {
  const object = objectAt(value, 'planes.json');
  return {
    frame: stringAt(object.frame, 'frame'),
    epoch: countAt(object.epoch, 'epoch'),
    revision: countAt(object.revision, 'revision'),
    planes: planesAt(object.planes, 'planes'),
  };
}
