import { fetchLicenses } from '../api/requests';
import { byId, el } from './dom';
import { SHORTCUTS } from './keyboard';

function fillDialog(id: string, titleId: string, title: string, ...content: HTMLElement[]): HTMLDialogElement {
  const dialog = byId<HTMLDialogElement>(id);
  const close = el('button', { type: 'button', class: 'close', 'aria-label': 'Close' }, '\u00d7');
  close.addEventListener('click', () => dialog.close());
  dialog.addEventListener('click', event => {
    if (event.target === dialog) dialog.close(); // beside it
  });
  dialog.replaceChildren(el('header', {}, el('h2', { id: titleId }, title), close), ...content);
  return dialog;
}

export function helpDialog(): () => void {
  const keys = SHORTCUTS.filter(({ label }) => label !== '').flatMap(({ shown, label }) => [
    el('dt', {}, el('kbd', {}, shown)),
    el('dd', {}, label),
  ]);
  const pointer = [
    ['Drag', 'turn; in the floor plan: shift'],
    ['Right drag, two fingers', 'shift'],
    ['Wheel, pinch', 'nearer and farther'],
    ['Click, tap', 'what is known of a plane'],
  ].flatMap(([what, does]) => [el('dt', {}, what!), el('dd', {}, does!)]);
  const dialog = fillDialog(
    'help-dialog',
    'help-title',
    'Help',
    el('h3', {}, 'Pointer'),
    el('dl', { class: 'keys' }, ...pointer),
    el('h3', {}, 'Keyboard'),
    el('dl', { class: 'keys' }, ...keys),
    el(
      'p',
      { class: 'note' },
      'A plane is drawn from the side from which the sensor saw it; from behind only its outline is left. ' +
        'Every \u00b1 is one standard deviation.',
    ),
  );
  return () => dialog.showModal();
}

export function licensesDialog(): () => void {
  const text = el('pre', { tabindex: '0' });
  const dialog = fillDialog('licenses-dialog', 'licenses-title', 'Licences of the code in this page', text);
  return () => {
    dialog.showModal();
    if (text.textContent) return;
    fetchLicenses().then(
      licenses => {
        text.textContent = licenses;
      },
      (error: unknown) => {
        text.textContent = `They could not be loaded: ${error instanceof Error ? error.message : error}`;
      },
    );
  };
}
