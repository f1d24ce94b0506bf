import './style/theme.css';
import './style/page.css';
import './style/panels.css';
import './style/phone.css';
import { Connection } from './api/connection';
import { EVENTS_URL } from './api/requests';
import type { PlaneColouring } from './colour/planes';
import { SettingsStore } from './settings';
import { choice } from './ui/choice';
import { controlsPanel } from './ui/controls_panel';
import { helpDialog, licensesDialog } from './ui/dialogs';
import { byId, el } from './ui/dom';
import { type Actions, listenToKeys } from './ui/keyboard';
import { setUpPanels } from './ui/panels';
import { listenToClicks } from './ui/pointer';
import { StatusBar } from './ui/status_bar';
import { Viewer } from './viewer';

const COLOURINGS: readonly PlaneColouring[] = ['plane', 'class', 'normal', 'offset'];

function start(): void {
  const store = new SettingsStore();
  const viewer = new Viewer(store);
  const panels = setUpPanels(open => viewer.panelChanged(open));
  const showHelp = helpDialog();
  controlsPanel(byId('controls'), store, licensesDialog());

  const actions: Actions = {
    move: move => viewer.viewport.move(move),
    colour: index => store.set({ colouring: COLOURINGS[index]! }),
    toggleLayer: layer => store.toggleLayer(layer),
    togglePlan: () => store.set({ view: store.current.view === 'plan' ? 'orbit' : 'plan' }),
    togglePause: () => store.set({ paused: !store.current.paused }),
    toggleMeasure: () => store.set({ measuring: !store.current.measuring }),
    toggleTheme: () => store.set({ theme: viewer.isDark ? 'light' : 'dark' }),
    togglePanel: panel => panels.toggle(panel),
    fit: () => viewer.fit(),
    fitSelected: () => viewer.fitSelected(),
    next: step => viewer.next(step),
    clear: () => viewer.clear(),
    help: showHelp,
  };
  listenToKeys(actions);
  listenToClicks(byId('view'), (x, y) => viewer.chooseAt(x, y));

  const markView = choice(
    byId('view-choice'),
    [
      { value: 'orbit', label: '3D', title: 'In perspective (V)' },
      { value: 'plan', label: 'Plan', title: 'From above, to scale (V)' },
    ],
    view => store.set({ view }),
  );
  const buttons = { fit: actions.fit, measure: actions.toggleMeasure, pause: actions.togglePause, help: actions.help };
  for (const [id, run] of Object.entries(buttons)) byId(id).addEventListener('click', run);
  const mark = () => {
    markView(store.current.view);
    byId('measure').setAttribute('aria-pressed', String(store.current.measuring));
    byId('pause').setAttribute('aria-pressed', String(store.current.paused));
    byId('pause').textContent = store.current.paused ? 'Resume' : 'Pause';
  };
  store.onChange(mark);
  mark();
  connect(viewer);
}

function connect(viewer: Viewer): void {
  const bar = new StatusBar(() => connection.open());
  const connection = new Connection(EVENTS_URL, {
    state: state => bar.setState(state),
    hello: hello => viewer.hello(hello),
    delta: delta => viewer.delta(delta),
    pose: pose => viewer.pose(pose),
    status: status => bar.setStatus(status),
  });
  connection.open();
  window.addEventListener('online', () => connection.open());
  // For tests: what is drawn, how often, and where.
  Object.assign(window, { planemapViewer: viewer });
}

try {
  start();
} catch (error) {
  const reason = error instanceof Error ? error.message : String(error);
  document.body.prepend(el('p', { class: 'fatal', role: 'alert' }, `This page cannot draw the map here: ${reason}`));
}
