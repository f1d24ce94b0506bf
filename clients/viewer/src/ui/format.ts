import type { Vec3 } from '../api/check';

const MINUS = '\u2212';

/** A number with so many places, with a true minus sign and no minus zero. */
export function fixed(value: number, places: number): string {
  const text = Math.abs(value).toFixed(places);
  return value < 0 && Number(text) !== 0 ? MINUS + text : text;
}

/** Two significant digits, never in powers of ten: what a standard deviation deserves. */
export function twoDigits(value: number): string {
  if (!(value > 0)) return '0';
  const places = Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(value))));
  return value.toFixed(places);
}

/** Places after the point for a value in metres that is known to sigma. */
function placesFor(sigma: number): number {
  return Math.min(5, Math.max(2, sigma > 0 ? 1 - Math.floor(Math.log10(sigma)) : 4));
}

export const metres = (value: number, sigma: number): string => `${fixed(value, placesFor(sigma))} m`;
export const millimetres = (value: number): string => `${twoDigits(1000 * value)} mm`;
export const degrees = (rad: number): string => `${twoDigits((rad * 180) / Math.PI)}°`;
export const degreesFixed = (rad: number, sigma: number): string => {
  const sigmaDeg = (sigma * 180) / Math.PI;
  const places = Math.min(4, Math.max(1, sigmaDeg > 0 ? 1 - Math.floor(Math.log10(sigmaDeg)) : 2));
  return `${fixed((rad * 180) / Math.PI, places)}°`;
};
export const squareMetres = (value: number): string => `${fixed(value, value < 10 ? 2 : 1)} m²`;
export const vector = (v: Vec3, places = 3): string => v.map(x => fixed(x, places)).join('  ');
export const count = (value: number): string => Math.round(value).toLocaleString('en').replaceAll(',', '\u202f');

/** 4 s, 3 min, 5 h, 2 d: the larger of two units would be a false precision. */
export function duration(seconds: number): string {
  if (seconds < 10) return `${fixed(seconds, 1)} s`;
  if (seconds < 120) return `${Math.round(seconds)} s`;
  if (seconds < 7200) return `${Math.round(seconds / 60)} min`;
  if (seconds < 172_800) return `${Math.round(seconds / 3600)} h`;
  return `${Math.round(seconds / 86_400)} d`;
}

export const clock = (ms: number): string => new Date(ms).toTimeString().slice(0, 8);

const EARLIEST_DATE_UTIME = 946_684_800_000_000; // of 2000: times before are those of a simulation or a log that counts from 0

/** When something was last seen, by the newest time that the map knows: "with the last scan", "12 s before the last scan". */
export function lastSeen(utime: number, newestUtime: number): string {
  const ago_s = Math.max(0, newestUtime - utime) / 1e6;
  const relative = ago_s < 0.5 ? 'in the last scan' : `${duration(ago_s)} before the last scan`;
  return utime >= EARLIEST_DATE_UTIME ? `${clock(utime / 1000)}, ${relative}` : relative;
}
