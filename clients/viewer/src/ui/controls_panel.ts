import { PLANE_CLASSES, type PlaneClass } from '../api/planes';
import { exportUrl } from '../api/requests';
import type { PlaneColouring } from '../colour/planes';
import { CONE_FACTOR } from '../scene/cones_layer';
import { LAYERS, type Layer, type Settings, type SettingsStore, type ThemeChoice } from '../settings';
import { choice } from './choice';
import { el } from './dom';

const LAYER_LABELS: Readonly<Record<Layer, readonly [label: string, key: string]>> = {
  planes: ['Planes', 'P'],
  outlines: ['Outlines', 'O'],
  cells: ['Cells', 'C'],
  cones: [`Cones of uncertainty, ${CONE_FACTOR} \u00d7 \u03c3`, 'U'],
  robot: ['Sensor and its path', 'R'],
  scan: ['Last scan', 'S'],
  grid: ['Grid', 'G'],
};
const COLOURINGS: readonly { value: PlaneColouring; label: string; title: string }[] = [
  { value: 'plane', label: 'Plane', title: 'Each plane its own colour (1)' },
  { value: 'class', label: 'Class', title: 'Floor, ceiling, wall, table, slope, other (2)' },
  { value: 'normal', label: '\u00b1 \u00b0', title: 'By the standard deviation of the normal (3)' },
  { value: 'offset', label: '\u00b1 mm', title: 'By the standard deviation of the offset at the centroid (4)' },
];
const THEMES: readonly { value: ThemeChoice; label: string }[] = [
  { value: 'auto', label: 'System' },
  { value: 'light', label: 'Light' },
  { value: 'dark', label: 'Dark' },
];
const EXPORTS = ['ply', 'obj', 'json', 'svg'] as const;
const LEAST_AREAS_M2 = [0, 0.1, 0.2, 0.5, 1, 2, 5, 10];
const LARGEST_DEVIATIONS_DEG = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, Number.POSITIVE_INFINITY];

/** What is shown, in which colours, which planes, and what can be taken away. */
export function controlsPanel(panel: HTMLElement, store: SettingsStore, showLicenses: () => void): void {
  const colours = el('div', { class: 'segments', role: 'radiogroup', 'aria-label': 'Colour planes by' });
  const theme = el('div', { class: 'segments', role: 'radiogroup', 'aria-label': 'Light or dark' });
  const markColouring = choice(colours, COLOURINGS, colouring => store.set({ colouring }));
  const markTheme = choice(theme, THEMES, value => store.set({ theme: value }));
  const layers = LAYERS.map(layer => layerBox(layer, store));
  const filters = filterControls(store);
  const licenses = el('button', { type: 'button', class: 'link', id: 'show-licenses' }, 'Licences');
  licenses.addEventListener('click', showLicenses);
  panel.append(
    section('Colour', colours),
    section('Layers', ...layers.map(l => l.row)),
    section('Filter', ...filters.rows),
    section('Download', el('div', { class: 'downloads' }, ...EXPORTS.map(downloadLink))),
    section('Appearance', theme),
    el('p', { class: 'foot' }, licenses),
  );
  const show = (settings: Settings) => {
    markColouring(settings.colouring);
    markTheme(settings.theme);
    for (const { layer, box } of layers) box.checked = settings.layers[layer];
    filters.show(settings);
  };
  store.onChange(show);
  show(store.current);
}

function section(title: string, ...children: HTMLElement[]): HTMLElement {
  return el('section', {}, el('h2', {}, title), ...children);
}

function layerBox(layer: Layer, store: SettingsStore) {
  const [label, key] = LAYER_LABELS[layer];
  const box = el('input', { type: 'checkbox', 'data-layer': layer });
  box.addEventListener('change', () => store.setLayer(layer, box.checked));
  return { layer, box, row: el('label', { class: 'check' }, box, el('span', {}, label), el('kbd', {}, key)) };
}

function downloadLink(extension: (typeof EXPORTS)[number]): HTMLElement {
  const name = extension.toUpperCase();
  const what = { ply: 'polygons as PLY', obj: 'polygons as OBJ', json: 'planes as JSON', svg: 'floor plan as SVG' }[
    extension
  ];
  return el('a', { href: exportUrl(extension), download: `planes.${extension}`, title: `Download the ${what}` }, name);
}

function filterControls(store: SettingsStore) {
  const change = (filter: Partial<Settings['filter']>) => store.set({ filter: { ...store.current.filter, ...filter } });
  const classes = PLANE_CLASSES.map(name => {
    const button = el('button', { type: 'button', class: 'chip', 'data-class': name, 'aria-pressed': 'true' }, name);
    button.addEventListener('click', () =>
      change({ hiddenClasses: toggled(store.current.filter.hiddenClasses, name) }),
    );
    return { name, button };
  });
  const area = slider('Least area', 'least-area', LEAST_AREAS_M2, value => change({ leastArea_m2: value }));
  const deviation = slider('Largest deviation', 'largest-deviation', LARGEST_DEVIATIONS_DEG, value =>
    change({ largestDeviation_rad: (value * Math.PI) / 180 }),
  );
  const chips = el('div', { class: 'chips', role: 'group', 'aria-label': 'Classes' }, ...classes.map(c => c.button));
  const rows: HTMLElement[] = [chips, area.row, deviation.row];
  const show = ({ filter }: Settings) => {
    for (const { name, button } of classes)
      button.setAttribute('aria-pressed', String(!filter.hiddenClasses.has(name)));
    area.show(filter.leastArea_m2, value => (value > 0 ? `${value} m²` : 'any'));
    const degrees = (filter.largestDeviation_rad * 180) / Math.PI;
    deviation.show(degrees, value => (Number.isFinite(value) ? `${Number(value.toPrecision(3))}°` : 'any'));
  };
  return { rows, show };
}

function toggled(set: ReadonlySet<PlaneClass>, name: PlaneClass): ReadonlySet<PlaneClass> {
  const copy = new Set(set);
  if (!copy.delete(name)) copy.add(name);
  return copy;
}

function slider(label: string, id: string, steps: readonly number[], choose: (value: number) => void) {
  const input = el('input', { type: 'range', id, min: '0', max: String(steps.length - 1), step: '1' });
  const output = el('output', { for: id });
  input.addEventListener('input', () => choose(steps[Number(input.value)]!));
  const row = el('div', { class: 'slider' }, el('label', { for: id }, label), output, input);
  const show = (value: number, text: (value: number) => string) => {
    const nearest = steps.findIndex(step => step >= value * (1 - 1e-9));
    input.value = String(nearest < 0 ? steps.length - 1 : nearest);
    output.textContent = text(value);
    input.setAttribute('aria-valuetext', text(value));
  };
  return { row, show };
}
