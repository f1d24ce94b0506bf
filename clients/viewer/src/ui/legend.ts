import type { Legend, ScaleLegend } from '../colour/planes';
import { sequential, toCss } from '../colour/scale';
import { CELL_SCALE_DEG } from '../scene/cells_layer';
import { byId, el, setText } from './dom';

const STEPS = 24;
const LONGEST_BAR_PX = 160;
const cellLegend: Legend = {
  kind: 'scale',
  title: 'Cells: \u00b1 of the normal',
  unit: '°',
  minimum: 0,
  maximum: CELL_SCALE_DEG,
};

/** The scales of what is coloured. */
export function showLegend(legend: HTMLElement, planes: Legend | null, cells: boolean): void {
  const shown = [planes, cells ? cellLegend : null].filter(l => l !== null);
  const key = JSON.stringify(shown);
  if (legend.dataset.shown === key) return;
  legend.dataset.shown = key;
  legend.replaceChildren(...shown.map(element));
  legend.hidden = shown.length === 0;
}

function element(legend: Legend): HTMLElement {
  if (legend.kind === 'swatches') {
    const items = legend.swatches.map(({ label, colour }) => {
      const swatch = el('i');
      swatch.style.background = toCss(colour);
      return el('li', {}, swatch, label);
    });
    return el('div', { class: 'swatches' }, el('h2', {}, legend.title), el('ul', {}, ...items));
  }
  const bar = el('div', { class: 'ramp' });
  const stops = Array.from({ length: STEPS + 1 }, (_, i) => toCss(sequential(i / STEPS)));
  bar.style.background = `linear-gradient(90deg, ${stops.join(', ')})`;
  const labels = ticksOf(legend).map(tick => el('span', {}, `${tick}${legend.unit === '°' ? '°' : ` ${legend.unit}`}`));
  return el('div', { class: 'scale' }, el('h2', {}, legend.title), bar, el('div', { class: 'ticks' }, ...labels));
}

/** Both ends and the middle, in the middle of the ramp: on a logarithmic scale the geometric mean. */
function ticksOf({ minimum, maximum }: ScaleLegend): number[] {
  const middle = minimum > 0 ? Math.sqrt(minimum * maximum) : (minimum + maximum) / 2;
  return [minimum, middle, maximum].map(tick => Number(tick.toPrecision(2)));
}

/** The longest of 1, 2, 5, 10, ... that fits. */
export function scaleBarLength(metresPerPixel: number): number {
  const longest = LONGEST_BAR_PX * metresPerPixel;
  const power = 10 ** Math.floor(Math.log10(longest));
  return ([5, 2, 1].find(step => step * power <= longest) ?? 1) * power;
}

export function showScaleBar(metresPerPixel: number | null): void {
  const bar = byId('scalebar');
  bar.hidden = metresPerPixel === null;
  if (metresPerPixel === null) return;
  const length = scaleBarLength(metresPerPixel);
  const text = length >= 1 ? `${length} m` : `${Number((100 * length).toPrecision(1))} cm`;
  setText(byId('scalebar-text'), text);
  byId('scalebar-line').style.width = `${length / metresPerPixel}px`;
  bar.setAttribute('aria-label', `Scale bar: ${text}`);
}
