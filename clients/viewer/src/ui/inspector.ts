import type { PlaneRecord } from '../api/planes';
import type { Measurement } from '../map/measure';
import { el } from './dom';
import { count, degrees, degreesFixed, lastSeen, metres, millimetres, squareMetres, vector } from './format';

export interface Inspected {
  readonly selected: PlaneRecord | null;
  readonly second: PlaneRecord | null;
  readonly measurement: Measurement | null;
  readonly measuring: boolean;
  readonly newestUtime: number; // of the map, µs
  readonly goneId: number | null; // was selected and is no plane any more
}

type Row = readonly [name: string, value: string, deviation?: string];

/** What is known of the selected plane, or of what lies between two. */
export class Inspector {
  private shown = '';

  constructor(
    private readonly panel: HTMLElement,
    private readonly close: () => void,
  ) {}

  show(inspected: Inspected): void {
    const { title, rows, note } = contentOf(inspected);
    this.panel.hidden = title === null;
    const key = JSON.stringify([title, rows, note]);
    if (title === null || key === this.shown) return;
    this.shown = key;
    const hadFocus = this.panel.contains(document.activeElement);
    const close = el(
      'button',
      { type: 'button', class: 'close', 'aria-label': 'Close', title: 'Close (Esc)' },
      '\u00d7',
    );
    close.addEventListener('click', this.close);
    const list = el('dl', {}, ...rows.flatMap(rowElements));
    this.panel.replaceChildren(el('header', {}, el('h2', {}, title), close), list);
    if (note) this.panel.append(el('p', { class: 'note' }, note));
    if (hadFocus) close.focus();
  }
}

function rowElements([name, value, deviation]: Row): HTMLElement[] {
  const field = el(
    'dd',
    { 'data-field': name.toLowerCase().replaceAll(' ', '-') },
    el('span', { class: 'value' }, value),
  );
  if (deviation) field.append(' ', el('span', { class: 'deviation' }, `\u00b1 ${deviation}`));
  return [el('dt', {}, name), field];
}

interface Content {
  readonly title: string | null;
  readonly rows: readonly Row[];
  readonly note: string;
}

function contentOf(inspected: Inspected): Content {
  const { selected, second, measurement, measuring, newestUtime, goneId } = inspected;
  if (selected && second && measurement) return measurementContent(selected, second, measurement);
  if (selected) {
    const note = measuring ? 'Now choose the other plane.' : '';
    return { title: `Plane ${selected.id}`, rows: planeRows(selected, newestUtime), note };
  }
  if (goneId !== null) {
    return { title: `Plane ${goneId}`, rows: [], note: 'It has left the map, or became part of another plane.' };
  }
  return { title: null, rows: [], note: '' };
}

function planeRows(plane: PlaneRecord, newestUtime: number): Row[] {
  const rows: Row[] = [
    ['Class', plane.class],
    ['Area', squareMetres(plane.area)],
    ['Normal', vector(plane.normal), degrees(plane.normalDeviation)],
    ['Offset', metres(plane.d, plane.offsetDeviation), millimetres(plane.offsetDeviation)],
    ['Centroid', `${vector(plane.centroid, 2)} m`],
    ['Points', count(plane.pointCount)],
    ['Cells', count(plane.cellCount)],
    ['Quality', plane.quality.toFixed(2)],
    ['Last seen', lastSeen(plane.lastSeenUtime, newestUtime)],
  ];
  if (plane.coplanarWith.length > 0) rows.push(['In line with', plane.coplanarWith.join(', ')]);
  return rows;
}

function measurementContent(a: PlaneRecord, b: PlaneRecord, measurement: Measurement): Content {
  const { distance, angle, parallel } = measurement;
  return {
    title: `Plane ${a.id} to plane ${b.id}`,
    rows: [
      ['Distance', metres(distance.value, distance.sigma), millimetres(distance.sigma)],
      ['Angle', degreesFixed(angle.value, angle.sigma), degrees(angle.sigma)],
    ],
    note: parallel
      ? 'The distance of the two planes at the middle between their centroids.'
      : `The planes meet; the distance is that of the centroid of plane ${b.id} from plane ${a.id}.`,
  };
}
