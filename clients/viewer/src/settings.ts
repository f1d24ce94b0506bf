import type { PlaneColouring } from './colour/planes';
import { NO_FILTER, type PlaneFilter } from './map/filter';
import type { ViewKind } from './scene/viewport';

export const LAYERS = ['planes', 'outlines', 'cells', 'cones', 'robot', 'scan', 'grid'] as const;
export type Layer = (typeof LAYERS)[number];
export type ThemeChoice = 'auto' | 'light' | 'dark';

/** What the user has chosen. */
export interface Settings {
  readonly view: ViewKind;
  readonly colouring: PlaneColouring;
  readonly layers: Readonly<Record<Layer, boolean>>;
  readonly filter: PlaneFilter;
  readonly theme: ThemeChoice;
  readonly paused: boolean;
  readonly measuring: boolean;
}

const DEFAULTS: Settings = {
  view: 'orbit',
  colouring: 'plane',
  layers: { planes: true, outlines: true, cells: false, cones: true, robot: true, scan: false, grid: true },
  filter: NO_FILTER,
  theme: 'auto',
  paused: false,
  measuring: false,
};
const STORAGE_KEY = 'planemap-viewer';

type Listener = (settings: Settings, before: Settings) => void;

/** The settings and who wants to know of them. Colours, layers and theme are kept in the browser. */
export class SettingsStore {
  private settings: Settings = { ...DEFAULTS, ...stored() };
  private readonly listeners: Listener[] = [];

  get current(): Settings {
    return this.settings;
  }

  onChange(listener: Listener): void {
    this.listeners.push(listener);
  }

  set(change: Partial<Settings>): void {
    const before = this.settings;
    this.settings = { ...before, ...change };
    for (const listener of this.listeners) listener(this.settings, before);
    const { colouring, layers, theme } = this.settings;
    try {
      localStorage.setItem(STORAGE_KEY, JSON.stringify({ colouring, layers, theme }));
    } catch {
      // a browser that keeps nothing: the page works as well
    }
  }

  setLayer(layer: Layer, visible: boolean): void {
    this.set({ layers: { ...this.settings.layers, [layer]: visible } });
  }

  toggleLayer(layer: Layer): void {
    this.setLayer(layer, !this.settings.layers[layer]);
  }
}

function stored(): Partial<Settings> {
  try {
    const value: unknown = JSON.parse(localStorage.getItem(STORAGE_KEY) ?? '{}');
    const known = value as Partial<Settings>;
    const colouring = (['plane', 'class', 'normal', 'offset'] as const).find(c => c === known.colouring);
    const theme = (['auto', 'light', 'dark'] as const).find(t => t === known.theme);
    const layers = Object.fromEntries(LAYERS.map(l => [l, known.layers?.[l] ?? DEFAULTS.layers[l]]));
    return {
      ...(colouring ? { colouring } : {}),
      ...(theme ? { theme } : {}),
      layers: layers as Settings['layers'],
    };
  } catch {
    return {};
  }
}
