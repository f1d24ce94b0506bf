import type { Color } from 'three';
import type { Rgb } from '../colour/scale';

/** sRGB bytes as they are: colour management is off in this scene. */
export function setColour(colour: Color, [r, g, b]: Rgb): void {
  colour.setRGB(r / 255, g / 255, b / 255);
}
