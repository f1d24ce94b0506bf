import type { Scan } from '../api/binary';
import type { Pose } from '../api/events';
import type { PlaneRecord } from '../api/planes';
import { type PlaneColours, planeColours } from '../colour/planes';
import { mix } from '../colour/scale';
import type { Theme } from '../colour/theme';
import { boundsOf } from '../map/bounds';
import type { CellStore } from '../map/cells';
import type { Measurement } from '../map/measure';
import { pickPlane } from '../map/pick';
import { tessellate } from '../map/tessellate';
import { pickWall } from '../map/wall_lines';
import type { Settings } from '../settings';
import { CellsLayer } from './cells_layer';
import { ConesLayer } from './cones_layer';
import { GridLayer } from './grid_layer';
import { HighlightLayer } from './highlight_layer';
import { MeasureLayer } from './measure_layer';
import { PlanesLayer } from './planes_layer';
import { RobotLayer } from './robot_layer';
import { ScanLayer } from './scan_layer';
import type { Viewport } from './viewport';
import { WallsLayer } from './walls_layer';

const WALL_REACH_PX = 9;
const DIMMED = 0.7;
const WALL_INK = 0.45; // share of the outlines' colour in walls seen from above
const DOWNWARD = -0.5; // of a normal's z: a plan has no outlines of ceilings

/** What is to be seen. `planes` are those that the filter lets through. */
export interface Shown {
  readonly planes: readonly PlaneRecord[];
  readonly cells: CellStore;
  readonly isFiltered: boolean;
  readonly selected: PlaneRecord | null;
  readonly second: PlaneRecord | null;
  readonly measurement: Measurement | null;
}

export type Part = 'planes' | 'cells' | 'selection';

/** The layers, filled when a frame is about to be drawn: however often the map changed since the last one, once. */
export class MapScene {
  colours: PlaneColours;
  private readonly planes = new PlanesLayer();
  private readonly walls = new WallsLayer();
  private readonly cells = new CellsLayer();
  private readonly cones = new ConesLayer();
  private readonly robot = new RobotLayer();
  private readonly scan = new ScanLayer();
  private readonly grid = new GridLayer();
  private readonly marks = [new HighlightLayer(), new HighlightLayer()] as const;
  private readonly ruler = new MeasureLayer();
  private readonly dirty = new Set<Part>();
  private cellBudget = Number.POSITIVE_INFINITY;
  private outlinesWanted = true;

  constructor(
    readonly viewport: Viewport,
    private shown: Shown,
    private settings: Settings,
    private theme: Theme,
  ) {
    this.colours = planeColours(settings.colouring, shown.planes, theme);
    const layers = [this.grid, this.planes, this.walls, this.cells, this.cones, this.scan, this.robot];
    viewport.scene.add(...[...layers, ...this.marks, this.ruler].map(layer => layer.object));
    viewport.beforeFrame = () => this.fill();
    viewport.onQuality = quality => {
      this.cellBudget = quality.cells;
      this.cells.budget = this.cellBudget;
      this.planes.outlinesVisible = this.outlinesWanted && quality.outlines;
    };
    this.setTheme(theme);
    this.apply(settings);
  }

  /** Takes what is to be seen now; of it, `parts` are other than before. */
  update(shown: Shown, ...parts: Part[]): void {
    this.shown = shown;
    for (const part of parts) this.dirty.add(part);
    if (parts.includes('planes')) this.colours = planeColours(this.settings.colouring, shown.planes, this.theme);
    this.viewport.invalidate();
  }

  apply(settings: Settings): void {
    const before = this.settings;
    const anew =
      settings.colouring !== before.colouring ||
      settings.layers.cells !== before.layers.cells ||
      settings.view !== before.view;
    this.settings = settings;
    const { layers } = settings;
    this.planes.surfacesVisible = layers.planes;
    this.outlinesWanted = layers.outlines;
    this.planes.outlinesVisible = layers.outlines;
    this.walls.object.visible = settings.view === 'plan' && layers.planes;
    this.cells.object.visible = layers.cells;
    this.cones.object.visible = layers.cones;
    this.robot.object.visible = layers.robot;
    this.scan.object.visible = layers.scan;
    this.grid.object.visible = layers.grid;
    this.viewport.setView(settings.view);
    if (anew) this.update(this.shown, 'planes');
    this.viewport.invalidate();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.viewport.background = theme.background;
    this.planes.setOutlineColour(theme.outline, theme.name === 'dark' ? 0.5 : 0.55);
    this.robot.setColours(theme.robot, theme.accent);
    this.scan.setColour(theme.scan);
    this.grid.setColour(theme.grid);
    this.ruler.setColour(theme.robot);
    this.update(this.shown, 'planes', 'cells', 'selection');
  }

  get drawnCells(): number {
    return this.cells.count;
  }

  get drawnCones(): number {
    return this.cones.object.count;
  }

  showPose(pose: Pose): void {
    if (this.robot.showPose(pose) && this.settings.layers.robot) this.viewport.invalidate();
  }

  showPath(poses: readonly Pose[]): void {
    this.robot.showPath(poses);
    if (this.settings.layers.robot) this.viewport.invalidate();
  }

  showScan(scan: Scan | null): void {
    this.scan.show(scan?.points ?? new Float32Array(0));
    if (this.settings.layers.scan) this.viewport.invalidate();
  }

  /** Brings these planes into view; else all. */
  fit(planes: readonly PlaneRecord[] = this.shown.planes): void {
    this.viewport.fit(planes.map(plane => tessellate(plane).positions));
  }

  /** The plane at a point of the page. */
  pick(clientX: number, clientY: number): PlaneRecord | null {
    const { origin, direction } = this.viewport.rayAt(clientX, clientY);
    if (this.viewport.viewKind === 'plan') {
      const reach_m = WALL_REACH_PX * this.viewport.metresPerPixel();
      const wall = pickWall(this.walls.lines, origin[0], origin[1], reach_m);
      if (wall) return wall;
    }
    return pickPlane(this.shown.planes, origin, direction);
  }

  /** Behind cells planes step back. */
  private surfaceColour(): PlaneColours['of'] {
    const { of } = this.colours;
    return this.settings.layers.cells ? plane => mix(of(plane), this.theme.background, DIMMED) : of;
  }

  private fill(): void {
    const { planes, cells, selected, second, measurement, isFiltered } = this.shown;
    if (this.dirty.has('planes')) {
      const fromAbove = this.settings.view === 'plan';
      this.planes.show(planes, this.surfaceColour(), plane => !fromAbove || plane.normal[2] > DOWNWARD);
      this.walls.show(planes, plane => mix(this.colours.of(plane), this.theme.outline, WALL_INK));
      const bounds = boundsOf(planes);
      if (bounds) this.grid.show(bounds);
    }
    if (this.dirty.has('cells') && this.settings.layers.cells) {
      const ids = new Set(planes.map(plane => plane.id));
      this.cells.show(cells, id => !isFiltered || ids.has(id), this.theme.unknown);
      this.cells.budget = this.cellBudget;
      this.dirty.delete('cells');
    }
    if (this.dirty.has('selection')) {
      this.marks[0].show(selected, this.theme.accent);
      this.marks[1].show(second, this.theme.second);
      this.cones.show(cells, selected?.id ?? 0);
      this.ruler.show(measurement ? [measurement.from, measurement.to] : null);
    }
    this.dirty.delete('planes');
    this.dirty.delete('selection');
  }
}
