import { el } from './dom';

export interface Option<T extends string> {
  readonly value: T;
  readonly label: string;
  readonly title?: string;
}

/** A row of which one is chosen: arrow keys go along it, as in every radio group. Returns what marks the chosen one. */
export function choice<T extends string>(
  group: HTMLElement,
  options: readonly Option<T>[],
  choose: (value: T) => void,
): (value: T) => void {
  const buttons = options.map(({ value, label, title }) => {
    const button = el(
      'button',
      { type: 'button', role: 'radio', 'data-value': value, ...(title ? { title } : {}) },
      label,
    );
    button.addEventListener('click', () => choose(value));
    return button;
  });
  group.append(...buttons);
  group.addEventListener('keydown', event => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    const at = buttons.indexOf(event.target as HTMLButtonElement);
    if (!step || at < 0) return;
    const next = (at + step + buttons.length) % buttons.length;
    event.preventDefault();
    event.stopPropagation();
    choose(options[next]!.value);
    buttons[next]!.focus();
  });
  return chosen => {
    for (const button of buttons) {
      const isChosen = button.dataset.value === chosen;
      button.setAttribute('aria-checked', String(isChosen));
      button.tabIndex = isChosen ? 0 : -1;
    }
  };
}
