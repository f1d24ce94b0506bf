import type { Delta, Hello } from './api/events';
import type { PlaneRecord } from './api/planes';
import { applyDelta, EMPTY_MAP, type MapState } from './map/state';

/** The map as the daemon has it, and the one that is looked at: the same, unless the view is paused. */
export class LiveMap {
  private live: MapState = EMPTY_MAP;
  private held: MapState | null = null;
  frame = '';

  get shown(): MapState {
    return this.held ?? this.live;
  }

  /** Revisions that a paused view is behind; 0: of another map altogether, or none. */
  get behind(): number {
    return this.held && this.held.epoch === this.live.epoch ? this.live.revision - this.held.revision : 0;
  }

  get revision(): number {
    return this.live.revision;
  }

  /** Of the newest sight of any plane that is shown, µs. */
  get newestUtime(): number {
    let newest = 0;
    for (const plane of this.shown.planes.values()) newest = Math.max(newest, plane.lastSeenUtime);
    return newest;
  }

  /** Returns whether another map has begun: a new one may be empty, and bring no delta for a long time. */
  hello(hello: Hello): boolean {
    this.frame = hello.frame;
    if (hello.epoch === this.live.epoch) return false;
    const isFirst = this.live.epoch === 0;
    this.live = { epoch: hello.epoch, revision: 0, planes: new Map() };
    return !isFirst;
  }

  /** Returns whether another map has begun. @throws GapError */
  apply(delta: Delta): boolean {
    const isNew = this.live.epoch !== 0 && this.live.epoch !== delta.epoch;
    this.live = applyDelta(this.live, delta);
    return isNew;
  }

  set paused(paused: boolean) {
    this.held = paused ? (this.held ?? this.live) : null;
  }

  plane(id: number | null): PlaneRecord | null {
    return id === null ? null : (this.shown.planes.get(id) ?? null);
  }
}
