import { type CellsUpdate, decodeCells, decodeScan, type Scan } from './binary';
import { type Pose, pathAt } from './events';

const API = 'api/v1';
export const EVENTS_URL = `${API}/events`;
export const LICENSES_URL = `${API}/licenses`;
export const exportUrl = (extension: string): string => `${API}/export/planes.${extension}`;

async function ask(path: string): Promise<Response> {
  const response = await fetch(`${API}/${path}`, { cache: 'no-store' });
  if (!response.ok) throw new Error(`${path}: ${response.status} ${response.statusText}`);
  return response;
}

/** Blocks that changed after the revision of the epoch; all for revision 0. */
export async function fetchCells(epoch: number, since: number): Promise<CellsUpdate> {
  const response = await ask(since > 0 ? `cells?since=${since}&epoch=${epoch}` : 'cells');
  return decodeCells(await response.arrayBuffer());
}

/** The last mapped scan; null where there is none yet. */
export async function fetchScan(): Promise<Scan | null> {
  const response = await ask('scan');
  return response.status === 204 ? null : decodeScan(await response.arrayBuffer());
}

export async function fetchPath(): Promise<Pose[]> {
  return pathAt(await (await ask('path')).json());
}

export async function fetchLicenses(): Promise<string> {
  return (await ask('licenses')).text();
}
