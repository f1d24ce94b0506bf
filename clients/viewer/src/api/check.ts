/** What comes over the wire is checked here; a `DecodeError` says what is wrong and where. */
export class DecodeError extends Error {
  override name = 'DecodeError';
}

export type Vec3 = readonly [number, number, number];
export type Quaternion = readonly [w: number, x: number, y: number, z: number];
export type JsonObject = Readonly<Record<string, unknown>>;

export function objectAt(value: unknown, where: string): JsonObject {
  if (typeof value !== 'object' || value === null || Array.isArray(value)) throw new DecodeError(`${where}: no object`);
  return value as JsonObject;
}

export function arrayAt(value: unknown, where: string): readonly unknown[] {
  if (!Array.isArray(value)) throw new DecodeError(`${where}: no array`);
  return value;
}

export function numberAt(value: unknown, where: string): number {
  if (typeof value !== 'number' || !Number.isFinite(value)) throw new DecodeError(`${where}: no finite number`);
  return value;
}

/** A whole number from 0 to 2^53 - 1: ids, epochs, revisions, counts. */
export function countAt(value: unknown, where: string): number {
  if (!Number.isSafeInteger(value) || (value as number) < 0) throw new DecodeError(`${where}: no count`);
  return value as number;
}

export function stringAt(value: unknown, where: string): string {
  if (typeof value !== 'string') throw new DecodeError(`${where}: no text`);
  return value;
}

export function numbersAt(value: unknown, length: number, where: string): readonly number[] {
  const numbers = arrayAt(value, where);
  if (numbers.length !== length || !numbers.every(n => Number.isFinite(n))) {
    throw new DecodeError(`${where}: not ${length} finite numbers`);
  }
  return numbers as readonly number[];
}

export function vec3At(value: unknown, where: string): Vec3 {
  return numbersAt(value, 3, where) as unknown as Vec3;
}

/** A unit quaternion; made of length 1 to the last bit. */
export function quaternionAt(value: unknown, where: string): Quaternion {
  const q = numbersAt(value, 4, where) as unknown as Quaternion;
  const length = Math.hypot(...q);
  if (Math.abs(length - 1) > 1e-3) throw new DecodeError(`${where}: a quaternion of length ${length}`);
  return [q[0] / length, q[1] / length, q[2] / length, q[3] / length];
}
