import { byId } from './dom';

export type PanelName = 'controls' | 'planes';
const PANELS: readonly PanelName[] = ['controls', 'planes'];
const NARROW = '(max-width: 720px)';

/** The panels at the left, one at a time: on a wide page open from the start, on a phone over the map when asked for. */
export function setUpPanels(opened: (panel: PanelName) => void): { toggle(panel: PanelName): void } {
  const tabs = [...document.querySelectorAll<HTMLButtonElement>('.tabs button')];
  const show = (open: PanelName | null) => {
    for (const name of PANELS) byId(name).hidden = name !== open;
    for (const tab of tabs) tab.setAttribute('aria-expanded', String(tab.dataset.panel === open));
    if (open) opened(open);
  };
  const toggle = (panel: PanelName) => show(byId(panel).hidden ? panel : null);
  for (const tab of tabs) tab.addEventListener('click', () => toggle(tab.dataset.panel as PanelName));
  show(window.matchMedia(NARROW).matches ? null : 'controls');
  return { toggle };
}
