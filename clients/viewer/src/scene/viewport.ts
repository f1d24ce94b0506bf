import {
  ColorManagement,
  LinearSRGBColorSpace,
  OrthographicCamera,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { Vec3 } from '../api/check';
import type { Rgb } from '../colour/scale';
import { fitView, type Points } from './fitting';
import { moveControls, setUpControls } from './navigation';
import { FULL, type Quality, QualityControl, SMOOTH } from './quality';

ColorManagement.enabled = false; // colours go to the screen as they are

export type ViewKind = 'orbit' | 'plan';

export interface Ray {
  readonly origin: Vec3;
  readonly direction: Vec3;
}

const REST_MS = 120;
const SMOOTH_MS = 350;
const FIELD_OF_VIEW_DEG = 50;
const MARGIN = 1.08;

/** Draws the scene when something has changed, and never else; less of it while the view moves. */
export class Viewport {
  readonly scene = new Scene();
  /** Frames drawn so far. */
  frames = 0;
  /** Called before each frame. */
  beforeFrame: () => void = () => {};
  /** Called before each frame that is drawn with another quality than the one before. */
  onQuality: (quality: Quality) => void = () => {};
  /** Called when a hand, not the page, begins to move the view. */
  onUserMove: () => void = () => {};
  /** Called after each frame. */
  onFrame: () => void = () => {};

  private readonly renderer: WebGLRenderer;
  private readonly perspective = new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 0.05, 2000);
  private readonly orthographic = new OrthographicCamera(-1, 1, 1, -1, -1000, 2000);
  private readonly controls: OrbitControls;
  private readonly quality: QualityControl;
  private drawn: Quality | null = null; // the quality of the last frame; null: the size of the canvas has changed since
  private pending = 0;
  private restTimer = 0;
  private readonly smooths: boolean; // edges, by a larger picture
  private smoothTimer = 0;
  private smoothing = false;
  private moving = false;
  private lastFrame_ms = 0;
  private kind: ViewKind = 'orbit';
  private covered = { left: 0, bottom: 0 }; // pixels

  /** @throws Error where the browser has no WebGL */
  constructor(private readonly canvas: HTMLCanvasElement) {
    const software = isSoftware();
    this.quality = new QualityControl(software);
    this.smooths = software;
    // Opaque, which three would not ask for: what lies below need not be drawn through it.
    const context = canvas.getContext('webgl2', { alpha: false, antialias: !software, stencil: false });
    if (!context) throw new Error('this browser has no WebGL 2');
    this.renderer = new WebGLRenderer({ canvas, context, alpha: false });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.perspective.up.set(0, 0, 1);
    this.perspective.position.set(-6, -8, 9);
    this.orthographic.up.set(0, 1, 0);
    this.orthographic.position.set(0, 0, 500);
    this.controls = new OrbitControls(this.perspective, canvas);
    setUpControls(this.controls, 'orbit');
    this.controls.addEventListener('change', () => this.moved());
    this.controls.addEventListener('start', () => this.onUserMove());
    new ResizeObserver(() => this.resized()).observe(canvas.parentElement!);
    canvas.addEventListener('webglcontextrestored', () => this.invalidate());
    this.resized();
  }

  get viewKind(): ViewKind {
    return this.kind;
  }

  /** Whether the last frame showed all there is. */
  get isComplete(): boolean {
    return this.drawn === FULL || this.drawn === SMOOTH;
  }

  /** Waits for what was drawn, which else goes on behind: for measurements. */
  finishDrawing(): void {
    const context = this.renderer.getContext();
    context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4));
  }

  set background(colour: Rgb) {
    const [r, g, b] = colour;
    this.renderer.setClearColor((r << 16) | (g << 8) | b);
    this.invalidate();
  }

  /** Asks for one frame; many asks before it are one. */
  invalidate(): void {
    if (this.pending === 0) this.pending = requestAnimationFrame(now => this.draw(now));
  }

  setView(kind: ViewKind): void {
    if (kind === this.kind) return;
    this.kind = kind;
    const target = this.controls.target;
    if (kind === 'plan') {
      const distance = this.perspective.position.distanceTo(target);
      const height = 2 * distance * Math.tan((FIELD_OF_VIEW_DEG / 2) * (Math.PI / 180));
      this.orthographic.zoom = 1;
      this.setPlanHeight(height);
      this.orthographic.position.set(target.x, target.y, target.z + 500);
    }
    this.controls.object = kind === 'plan' ? this.orthographic : this.perspective;
    setUpControls(this.controls, kind);
    this.controls.update();
    this.resized();
  }

  /** Brings the points into view, from where the camera looks now. */
  fit(clouds: readonly Points[]): void {
    const free = this.free();
    const slope = Math.tan((FIELD_OF_VIEW_DEG / 2) * (Math.PI / 180));
    const offset = this.perspective.position.clone().sub(this.controls.target).normalize();
    const seen = fitView(clouds, offset, slope * free.width, slope * free.height);
    const above = fitView(clouds, new Vector3(0, 0, 1), slope * free.width, slope * free.height);
    if (!seen || !above) return;
    const isPlan = this.kind === 'plan';
    this.perspective.position.copy(seen.target).addScaledVector(offset, Math.max(1, MARGIN * seen.distance));
    this.controls.target.copy(isPlan ? above.target : seen.target);
    this.orthographic.position.copy(this.controls.target).setZ(this.controls.target.z + 500);
    this.orthographic.zoom = 1;
    this.setPlanHeight(Math.max(1, MARGIN * 2 * slope * above.distance));
    this.controls.update();
    this.invalidate();
  }

  /** Keeps what is looked at in the middle of what panels at the left and the lower edge leave free. Pixels. */
  cover(left: number, bottom: number): void {
    if (left === this.covered.left && bottom === this.covered.bottom) return;
    this.covered = { left, bottom };
    this.resized();
  }

  /** Moves by keys: shares of the view's height, or of a turn. */
  move(action: Parameters<typeof moveControls>[1]): void {
    this.onUserMove();
    moveControls(this.controls, action);
    this.moved();
  }

  /** The ray through a point of the page, map frame. */
  rayAt(clientX: number, clientY: number): Ray {
    const box = this.canvas.getBoundingClientRect();
    const point = new Vector2(((clientX - box.left) / box.width) * 2 - 1, 1 - ((clientY - box.top) / box.height) * 2);
    const caster = new Raycaster();
    caster.setFromCamera(point, this.controls.object as PerspectiveCamera | OrthographicCamera);
    return { origin: caster.ray.origin.toArray(), direction: caster.ray.direction.toArray() };
  }

  /** Where a point of the map is on the page, pixels. */
  project(point: Vec3): { x: number; y: number } {
    const p = new Vector3(...point).project(this.controls.object);
    const box = this.canvas.getBoundingClientRect();
    return { x: box.left + ((p.x + 1) / 2) * box.width, y: box.top + ((1 - p.y) / 2) * box.height };
  }

  /** Of the plan view; the view from where the target is in perspective has none that holds everywhere. */
  metresPerPixel(): number {
    return (this.orthographic.top - this.orthographic.bottom) / this.orthographic.zoom / this.canvas.clientHeight;
  }

  /** Width and height of what no panel covers, as shares of the canvas's height. */
  private free(): { width: number; height: number } {
    const { clientWidth, clientHeight } = this.canvas;
    const share = (pixels: number) => Math.max(0.2, pixels / Math.max(1, clientHeight));
    return { width: share(clientWidth - this.covered.left), height: share(clientHeight - this.covered.bottom) };
  }

  private aspect(): number {
    return this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight);
  }

  private setPlanHeight(height: number): void {
    this.orthographic.top = height / 2;
    this.orthographic.bottom = -height / 2;
    this.updateCameras();
  }

  private updateCameras(): void {
    const aspect = this.aspect();
    this.perspective.aspect = aspect;
    this.orthographic.right = this.orthographic.top * aspect;
    this.orthographic.left = -this.orthographic.right;
    const { clientWidth, clientHeight } = this.canvas;
    for (const camera of [this.perspective, this.orthographic]) {
      camera.setViewOffset(
        clientWidth,
        clientHeight,
        -this.covered.left / 2,
        this.covered.bottom / 2,
        clientWidth,
        clientHeight,
      );
    }
  }

  private resized(): void {
    this.updateCameras();
    this.drawn = null;
    this.invalidate();
  }

  private moved(): void {
    this.moving = true;
    window.clearTimeout(this.restTimer);
    this.restTimer = window.setTimeout(() => {
      this.moving = false;
      this.invalidate();
    }, REST_MS);
    this.invalidate();
  }

  private draw(now_ms: number): void {
    this.pending = 0;
    this.controls.update(); // goes on gliding after the pointer has let go; asks for the next frame by `change`
    if (this.moving && this.drawn) this.quality.frame(now_ms - this.lastFrame_ms);
    this.lastFrame_ms = now_ms;
    this.beforeFrame();
    this.setQuality(this.moving ? this.quality.current : this.smoothing ? SMOOTH : FULL);
    this.renderer.render(this.scene, this.controls.object);
    ++this.frames;
    this.onFrame();
    window.clearTimeout(this.smoothTimer);
    if (this.smooths && !this.moving && !this.smoothing) {
      this.smoothTimer = window.setTimeout(() => {
        this.smoothing = true;
        this.invalidate();
      }, SMOOTH_MS);
    }
    this.smoothing = false;
  }

  private setQuality(quality: Quality): void {
    if (quality === this.drawn) return;
    this.drawn = quality;
    const own = Math.min(window.devicePixelRatio, 2);
    const { clientWidth, clientHeight } = this.canvas;
    this.renderer.setPixelRatio(Math.min(2, own * quality.pixelRatio));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.onQuality(quality);
  }
}

/** Whether WebGL is drawn by the processor: there smoothing of edges costs more than it is worth while moving. */
function isSoftware(): boolean {
  const context = document.createElement('canvas').getContext('webgl2');
  const info = context?.getExtension('WEBGL_debug_renderer_info');
  const name = info ? String(context?.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
