import type { Move } from '../scene/navigation';
import type { Layer } from '../settings';

/** What keys can do. */
export interface Actions {
  move(move: Move): void;
  colour(index: number): void;
  toggleLayer(layer: Layer): void;
  togglePlan(): void;
  togglePause(): void;
  toggleMeasure(): void;
  toggleTheme(): void;
  togglePanel(panel: 'controls' | 'planes'): void;
  fit(): void;
  fitSelected(): void;
  next(step: 1 | -1): void;
  clear(): void;
  help(): void;
}

interface Shortcut {
  readonly keys: readonly string[];
  readonly label: string; // for the help; '' where another line tells of it
  readonly shown: string;
  readonly run: (actions: Actions, event: KeyboardEvent) => void;
}

const TURN = Math.PI / 24;
const turn = (key: string, azimuth: number, polar: number, right: number, up: number): Shortcut => ({
  keys: [key],
  label: '',
  shown: '',
  run: (actions, event) => {
    actions.move(event.shiftKey ? { shift: [right, up] } : { turn: [azimuth, polar] });
  },
});
const layer = (key: string, name: Layer, label: string): Shortcut => ({
  keys: [key],
  label,
  shown: key.toUpperCase(),
  run: actions => actions.toggleLayer(name),
});

export const SHORTCUTS: readonly Shortcut[] = [
  turn('ArrowLeft', -TURN, 0, -0.06, 0),
  turn('ArrowRight', TURN, 0, 0.06, 0),
  turn('ArrowUp', 0, -TURN, 0, 0.06),
  { ...turn('ArrowDown', 0, TURN, 0, -0.06), label: 'turn; with Shift: shift', shown: '\u2190 \u2191 \u2193 \u2192' },
  { keys: ['+', '='], label: 'nearer', shown: '+', run: actions => actions.move({ nearer: 1.2 }) },
  { keys: ['-'], label: 'farther', shown: '\u2212', run: actions => actions.move({ nearer: 1 / 1.2 }) },
  { keys: ['f'], label: 'everything into view', shown: 'F', run: actions => actions.fit() },
  { keys: ['z'], label: 'selected plane into view', shown: 'Z', run: actions => actions.fitSelected() },
  { keys: ['v'], label: 'floor plan, and back', shown: 'V', run: actions => actions.togglePlan() },
  { keys: ['n'], label: 'next plane, by size', shown: 'N', run: actions => actions.next(1) },
  { keys: ['b'], label: 'plane before', shown: 'B', run: actions => actions.next(-1) },
  { keys: ['m'], label: 'measure between two planes', shown: 'M', run: actions => actions.toggleMeasure() },
  { keys: ['Escape'], label: 'let go of what is selected', shown: 'Esc', run: actions => actions.clear() },
  { keys: [' '], label: 'pause, and go on', shown: 'Space', run: actions => actions.togglePause() },
  ...['1', '2', '3', '4'].map((key, i) => ({
    keys: [key],
    label: ['colour by plane', 'by class', 'by \u00b1 degrees', 'by \u00b1 millimetres'][i]!,
    shown: key,
    run: (actions: Actions) => actions.colour(i),
  })),
  layer('p', 'planes', 'planes'),
  layer('o', 'outlines', 'outlines'),
  layer('c', 'cells', 'cells'),
  layer('u', 'cones', 'cones of uncertainty'),
  layer('r', 'robot', 'sensor and path'),
  layer('s', 'scan', 'last scan'),
  layer('g', 'grid', 'grid'),
  { keys: ['l'], label: 'list of planes', shown: 'L', run: actions => actions.togglePanel('planes') },
  { keys: ['h'], label: 'settings at the left', shown: 'H', run: actions => actions.togglePanel('controls') },
  { keys: ['t'], label: 'light or dark', shown: 'T', run: actions => actions.toggleTheme() },
  { keys: ['?'], label: 'this help', shown: '?', run: actions => actions.help() },
];

/** Keys do what they do unless a field or a dialog has them. */
export function listenToKeys(actions: Actions): void {
  document.addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
    const target = event.target as Element;
    const field = target.matches('input[type=range]') || target.matches('input[type=text]');
    if (field && event.key.startsWith('Arrow')) return;
    if (event.key === ' ' && target.matches('button, input, a')) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const shortcut = SHORTCUTS.find(({ keys }) => keys.includes(key));
    if (!shortcut) return;
    event.preventDefault();
    shortcut.run(actions, event);
  });
}
