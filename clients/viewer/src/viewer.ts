import type { Delta, Hello, Pose } from './api/events';
import type { PlaneRecord } from './api/planes';
import { Poller } from './api/poller';
import { fetchCells, fetchPath, fetchScan } from './api/requests';
import { THEMES, type Theme } from './colour/theme';
import { LiveMap } from './live_map';
import { boundsOf, sizeOf } from './map/bounds';
import { CellStore } from './map/cells';
import { accepts, NO_FILTER } from './map/filter';
import { MapScene, type Part, type Shown } from './scene/map_scene';
import { Viewport } from './scene/viewport';
import { Selection } from './selection';
import type { Settings, SettingsStore } from './settings';
import { byId, setText } from './ui/dom';
import { Inspector } from './ui/inspector';
import { showLegend, showScaleBar } from './ui/legend';
import { isNarrow, type PanelName } from './ui/panels';
import { PlaneList } from './ui/plane_list';

const CELLS_PERIOD_MS = 200;
const SCAN_PERIOD_MS = 200;
const GROWN = 1.02; // the view follows a map that has grown by more

/** Brings together the map, what is chosen, the scene and the panels. */
export class Viewer {
  readonly map = new LiveMap();
  readonly viewport: Viewport;
  readonly scene: MapScene;
  readonly list: PlaneList;
  private readonly cells = new CellStore();
  private readonly selection = new Selection(this.map);
  private readonly inspector: Inspector;
  private readonly cellPoller = new Poller(CELLS_PERIOD_MS, () => this.loadCells());
  private readonly scanPoller = new Poller(SCAN_PERIOD_MS, async () => this.scene.showScan(await fetchScan()));
  private readonly darkQuery = window.matchMedia('(prefers-color-scheme: dark)');
  private visible: readonly PlaneRecord[] = [];
  private fittedSize = 0;
  private follows = true; // the view has not been moved by hand yet

  constructor(private readonly store: SettingsStore) {
    this.viewport = new Viewport(byId<HTMLCanvasElement>('view'));
    this.scene = new MapScene(this.viewport, this.shown(), store.current, this.theme());
    this.inspector = new Inspector(byId('inspector'), () => this.clear());
    this.list = new PlaneList(byId('planes'), id => this.choose(id));
    this.viewport.onFrame = () => {
      showScaleBar(store.current.view === 'plan' ? this.viewport.metresPerPixel() : null);
    };
    this.viewport.onUserMove = () => {
      this.follows = false;
    };
    this.darkQuery.addEventListener('change', () => this.applyTheme());
    store.onChange((settings, before) => this.settingsChanged(settings, before));
    this.applyTheme();
    this.refresh('planes', 'cells', 'selection');
  }

  get planes(): readonly PlaneRecord[] {
    return this.visible;
  }

  hello(hello: Hello): void {
    if (this.map.hello(hello)) this.beginAnew();
    fetchPath().then(
      poses => this.scene.showPath(poses),
      () => {}, // the stream tells that the daemon is gone
    );
    if (this.store.current.layers.scan) this.scanPoller.want();
  }

  delta(delta: Delta): void {
    if (this.map.apply(delta)) this.beginAnew();
    if (this.store.current.paused) {
      this.showPaused();
      return;
    }
    this.refresh('planes', 'selection');
    if (delta.full || delta.blocksChanged > 0) this.wantCells();
  }

  pose(pose: Pose): void {
    if (this.store.current.paused) return;
    this.scene.showPose(pose);
    if (this.store.current.layers.scan) this.scanPoller.want();
  }

  /** Selects a plane; while measuring, the two ends one after the other. */
  choose(id: number | null): void {
    this.selection.choose(id, this.store.current.measuring);
    this.refresh('selection');
    this.wantCells();
  }

  chooseAt(clientX: number, clientY: number): void {
    this.choose(this.scene.pick(clientX, clientY)?.id ?? null);
  }

  /** The next plane by size. */
  next(step: 1 | -1): void {
    const bySize = [...this.visible].sort((a, b) => b.area - a.area);
    const at = bySize.findIndex(plane => plane.id === this.selection.selectedId);
    const next = bySize.at(at < 0 ? (step > 0 ? 0 : -1) : (at + step) % bySize.length);
    if (next) this.choose(next.id);
  }

  clear(): void {
    this.selection.choose(null, false);
    if (this.store.current.measuring) this.store.set({ measuring: false });
    this.refresh('selection');
  }

  fit(): void {
    this.follows = true;
    this.scene.fit();
  }

  fitSelected(): void {
    const { selected } = this.selection;
    if (!selected) return;
    this.follows = false;
    this.scene.fit([selected]);
  }

  panelChanged(open: PanelName | null): void {
    if (open === 'planes') this.list.show(this.visible, this.selection.selectedId);
    this.coverByPanels();
    this.follow(true);
  }

  get isDark(): boolean {
    return this.theme().name === 'dark';
  }

  /** What panels cover: at the left on wide pages, below on phones. */
  private coverByPanels(): void {
    const open = ['controls', 'planes', 'inspector'].map(id => byId(id)).filter(panel => !panel.hidden);
    const boxes = open.map(panel => panel.getBoundingClientRect());
    if (isNarrow()) {
      const lowerEdge = byId('view').getBoundingClientRect().bottom;
      this.viewport.cover(0, Math.max(0, ...boxes.map(box => lowerEdge - box.top)));
    } else {
      const atLeft = boxes.filter((_, i) => open[i]!.id !== 'inspector');
      this.viewport.cover(Math.max(0, ...atLeft.map(box => box.right)), 0);
    }
  }

  private theme(): Theme {
    const { theme } = this.store.current;
    return THEMES[theme === 'auto' ? (this.darkQuery.matches ? 'dark' : 'light') : theme];
  }

  private applyTheme(): void {
    const theme = this.theme();
    document.documentElement.dataset.theme = theme.name;
    this.scene.setTheme(theme);
    this.showLegends();
  }

  private shown(): Shown {
    const { filter } = this.store.current;
    return {
      planes: this.visible,
      cells: this.cells,
      isFiltered: filter !== NO_FILTER,
      selected: this.selection.selected,
      second: this.selection.second,
      measurement: this.selection.measurement,
    };
  }

  private refresh(...parts: Part[]): void {
    if (parts.includes('planes')) {
      const { filter } = this.store.current;
      this.visible = [...this.map.shown.planes.values()].filter(plane => accepts(filter, plane));
    }
    this.scene.update(this.shown(), ...parts);
    this.inspector.show({
      ...this.shown(),
      measuring: this.store.current.measuring,
      newestUtime: this.map.newestUtime,
      goneId: this.selection.goneId,
    });
    if (isNarrow()) this.coverByPanels();
    this.list.show(this.visible, this.selection.selectedId);
    if (parts.includes('planes')) {
      this.showLegends();
      this.follow();
    }
    this.showHint();
  }

  private settingsChanged(settings: Settings, before: Settings): void {
    this.map.paused = settings.paused;
    if (settings.theme !== before.theme) this.applyTheme();
    this.scene.apply(settings);
    if (!settings.measuring && before.measuring) this.selection.endMeasuring();
    const planesChanged = settings.filter !== before.filter || settings.paused !== before.paused;
    this.refresh(...((planesChanged ? ['planes', 'cells', 'selection'] : ['cells', 'selection']) as Part[]));
    this.showLegends();
    this.wantCells();
    if (settings.view !== before.view) this.follow(true);
    if (settings.layers.scan && !before.layers.scan) this.scanPoller.want();
  }

  private showLegends(): void {
    showLegend(byId('legend'), this.scene.colours.legend, this.store.current.layers.cells);
  }

  private showHint(): void {
    const { measuring, paused } = this.store.current;
    const behind = this.map.behind;
    let text = '';
    if (paused) text = behind > 0 ? `Paused, ${behind} ${behind === 1 ? 'revision' : 'revisions'} behind` : 'Paused';
    else if (measuring && !this.selection.second) {
      text = this.selection.selected ? 'Choose the second plane' : 'Choose the first plane';
    } else if (this.map.shown.planes.size === 0) text = 'No planes yet';
    else if (this.visible.length === 0) text = 'The filter hides all planes';
    const hint = byId('hint');
    hint.hidden = text === '';
    setText(hint, text);
  }

  private beginAnew(): void {
    this.cells.clear();
    this.scene.showScan(null);
    if (this.store.current.paused) this.showPaused();
    else this.refresh('planes', 'cells', 'selection');
  }

  private showPaused(): void {
    this.showHint();
  }

  /** A map that grows stays in view until somebody takes the view in hand. */
  private follow(anew = false): void {
    const bounds = this.follows ? boundsOf(this.visible) : null;
    if (!bounds) return;
    const size = Math.hypot(...sizeOf(bounds));
    if (anew || size > this.fittedSize * GROWN || size < this.fittedSize / 2) {
      this.fittedSize = size;
      this.scene.fit();
    }
  }

  /** Cells are asked for only where they are looked at: as points, or as cones of the selected plane. */
  private wantCells(): void {
    const { layers, paused } = this.store.current;
    if (!paused && (layers.cells || (layers.cones && this.selection.selected))) this.cellPoller.want();
  }

  private async loadCells(): Promise<void> {
    if (!this.cells.apply(await fetchCells(this.cells.epoch, this.cells.revision))) this.cellPoller.want();
    if (!this.store.current.paused) this.refresh('cells', 'selection');
  }
}
