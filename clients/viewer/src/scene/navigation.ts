import { MOUSE, type OrthographicCamera, TOUCH, Vector3 } from 'three';
import type { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { ViewKind } from './viewport';

/** A step of the view: a turn (rad), a shift (shares of the view's height), or nearer by a factor. */
export type Move =
  | { readonly turn: readonly [azimuth: number, polar: number] }
  | { readonly shift: readonly [right: number, up: number] }
  | { readonly nearer: number };

export function setUpControls(controls: OrbitControls, kind: ViewKind): void {
  const plan = kind === 'plan';
  controls.enableRotate = !plan;
  controls.screenSpacePanning = true;
  controls.enableDamping = true;
  controls.dampingFactor = 0.18;
  controls.zoomToCursor = true;
  controls.minDistance = 0.2;
  controls.maxDistance = 600;
  controls.minZoom = 0.02;
  controls.maxZoom = 200;
  controls.mouseButtons = { LEFT: plan ? MOUSE.PAN : MOUSE.ROTATE, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
  controls.touches = { ONE: plan ? TOUCH.PAN : TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN };
}

export function moveControls(controls: OrbitControls, move: Move): void {
  const camera = controls.object;
  const offset = camera.position.clone().sub(controls.target);
  if ('turn' in move) {
    if (!controls.enableRotate) return;
    const horizontal = Math.hypot(offset.x, offset.y);
    const azimuth = Math.atan2(offset.y, offset.x) + move.turn[0];
    const polar = Math.min(Math.PI - 0.01, Math.max(0.01, Math.atan2(horizontal, offset.z) + move.turn[1]));
    const radius = offset.length();
    offset.set(Math.cos(azimuth) * Math.sin(polar), Math.sin(azimuth) * Math.sin(polar), Math.cos(polar));
    camera.position.copy(controls.target).addScaledVector(offset, radius);
  } else if ('shift' in move) {
    const plan = camera as OrthographicCamera;
    const height = plan.isOrthographicCamera ? (plan.top - plan.bottom) / plan.zoom : offset.length();
    const right = new Vector3().setFromMatrixColumn(camera.matrix, 0).multiplyScalar(move.shift[0] * height);
    const up = new Vector3().setFromMatrixColumn(camera.matrix, 1).multiplyScalar(move.shift[1] * height);
    camera.position.add(right).add(up);
    controls.target.add(right).add(up);
  } else {
    const plan = camera as OrthographicCamera;
    if (plan.isOrthographicCamera) {
      plan.zoom = Math.min(controls.maxZoom, Math.max(controls.minZoom, plan.zoom * move.nearer));
      plan.updateProjectionMatrix();
    } else {
      camera.position.copy(controls.target).addScaledVector(offset, 1 / move.nearer);
    }
  }
  controls.update();
}
