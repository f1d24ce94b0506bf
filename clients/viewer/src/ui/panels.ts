import { byId } from './dom';

export type PanelName = 'controls' | 'planes';
const PANELS: readonly PanelName[] = ['controls', 'planes'];

/** Whether the page is laid out as for a phone: see style/phone.css. */
export const isNarrow = (): boolean => window.matchMedia('(max-width: 720px)').matches;

/** The panels at the left, one at a time: on a wide page open from the start, on a phone over the map when asked for. */
export function setUpPanels(changed: (open: PanelName | null) => void): { toggle(panel: PanelName): void } {
  const tabs = [...document.querySelectorAll<HTMLButtonElement>('.tabs button')];
  const show = (open: PanelName | null) => {
    for (const name of PANELS) byId(name).hidden = name !== open;
    for (const tab of tabs) tab.setAttribute('aria-expanded', String(tab.dataset.panel === open));
    changed(open);
  };
  const toggle = (panel: PanelName) => show(byId(panel).hidden ? panel : null);
  for (const tab of tabs) tab.addEventListener('click', () => toggle(tab.dataset.panel as PanelName));
  show(isNarrow() ? null : 'controls');
  return { toggle };
}
