import type { PlaneRecord } from './api/planes';
import type { LiveMap } from './live_map';
import { type Measurement, measure } from './map/measure';

/** The plane that is selected, and while measuring the other one. Ids, so that both follow what becomes of the planes. */
export class Selection {
  private first: number | null = null;
  private other: number | null = null;

  constructor(private readonly map: LiveMap) {}

  get selected(): PlaneRecord | null {
    return this.map.plane(this.first);
  }

  get second(): PlaneRecord | null {
    return this.map.plane(this.other);
  }

  get measurement(): Measurement | null {
    const { selected, second } = this;
    return selected && second ? measure(selected, second) : null;
  }

  get selectedId(): number | null {
    return this.first;
  }

  /** Was selected and is not in the map any more. */
  get goneId(): number | null {
    return this.first !== null && !this.selected ? this.first : null;
  }

  /** While measuring the second choice is the other plane, the third begins anew. */
  choose(id: number | null, measuring: boolean): void {
    const asOther = measuring && id !== null && this.selected && this.other === null && id !== this.first;
    if (asOther) {
      this.other = id;
    } else {
      this.first = id;
      this.other = null;
    }
  }

  endMeasuring(): void {
    this.other = null;
  }
}
