import { DecodeError } from '../api/check';
import type { Delta } from '../api/events';
import type { PlaneRecord } from '../api/planes';

/** The planes at one revision. Never changed: a view may keep one while newer ones are made. */
export interface MapState {
  readonly epoch: number;
  readonly revision: number;
  readonly planes: ReadonlyMap<number, PlaneRecord>;
}

export const EMPTY_MAP: MapState = { epoch: 0, revision: 0, planes: new Map() };

/** The delta does not go on from what is known: all must be asked for again. */
export class GapError extends DecodeError {
  override name = 'GapError';
}

/** The state after the delta. @throws GapError if the delta is of another epoch or leaves revisions out */
export function applyDelta(state: MapState, delta: Delta): MapState {
  if (!delta.full && delta.epoch !== state.epoch)
    throw new GapError(`a delta of map ${delta.epoch}, not ${state.epoch}`);
  if (!delta.full && delta.since > state.revision) {
    throw new GapError(`a delta since revision ${delta.since}; known is ${state.revision}`);
  }
  const planes = new Map(delta.full ? [] : state.planes);
  for (const id of delta.removed) planes.delete(id);
  for (const plane of delta.planes) planes.set(plane.id, plane);
  return { epoch: delta.epoch, revision: delta.revision, planes };
}
