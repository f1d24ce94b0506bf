import type { PlaneRecord } from '../api/planes';
import { el, setText } from './dom';
import { count, degrees, millimetres, squareMetres } from './format';

const MOST_ROWS = 200;
const PERIOD_MS = 500;

/** The planes as a list, largest first: the way to them by keyboard, and for those who do not see the picture. */
export class PlaneList {
  private readonly title = el('h2');
  private readonly list = el('ul');
  private readonly more = el('p', { class: 'note' });
  private planes: readonly PlaneRecord[] = [];
  private selectedId: number | null = null;
  private timer = 0;

  constructor(
    private readonly panel: HTMLElement,
    choose: (id: number) => void,
  ) {
    panel.append(this.title, this.list, this.more);
    this.list.addEventListener('click', event => {
      const id = (event.target as Element).closest('button')?.dataset.id;
      if (id) choose(Number(id));
    });
  }

  show(planes: readonly PlaneRecord[], selectedId: number | null): void {
    this.planes = planes;
    this.selectedId = selectedId;
    if (this.panel.hidden || this.timer !== 0) return;
    this.fill();
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      if (this.planes !== planes || this.selectedId !== selectedId) this.show(this.planes, this.selectedId);
    }, PERIOD_MS);
  }

  private fill(): void {
    const largest = [...this.planes].sort((a, b) => b.area - a.area).slice(0, MOST_ROWS);
    const focused = (document.activeElement as HTMLElement | null)?.dataset.id;
    setText(this.title, `${count(this.planes.length)} planes`);
    this.list.replaceChildren(...largest.map(plane => this.row(plane)));
    if (focused) this.list.querySelector<HTMLElement>(`[data-id="${focused}"]`)?.focus();
    const rest = this.planes.length - largest.length;
    this.more.hidden = rest === 0;
    setText(this.more, `and ${count(rest)} smaller ones; the filter narrows them down`);
  }

  private row(plane: PlaneRecord): HTMLElement {
    const button = el(
      'button',
      { type: 'button', 'data-id': String(plane.id), 'aria-current': String(plane.id === this.selectedId) },
      el('b', {}, String(plane.id)),
      el('span', {}, plane.class),
      el('span', { class: 'number' }, squareMetres(plane.area)),
      el('span', { class: 'number' }, `\u00b1 ${degrees(plane.normalDeviation)}`),
      el('span', { class: 'number' }, `\u00b1 ${millimetres(plane.offsetDeviation)}`),
    );
    return el('li', {}, button);
  }
}
