const SLACK_PX = 5;
const LONGEST_MS = 600;

/** Clicks and taps, told from drags by how far and how long the pointer went. */
export function listenToClicks(element: HTMLElement, click: (clientX: number, clientY: number) => void): void {
  let down: { id: number; x: number; y: number; at: number } | null = null;
  element.addEventListener('pointerdown', event => {
    down =
      event.isPrimary && event.button === 0
        ? { id: event.pointerId, x: event.clientX, y: event.clientY, at: event.timeStamp }
        : null;
  });
  element.addEventListener('pointerup', event => {
    if (!down || event.pointerId !== down.id) return;
    const near = Math.hypot(event.clientX - down.x, event.clientY - down.y) <= SLACK_PX;
    if (near && event.timeStamp - down.at <= LONGEST_MS) click(event.clientX, event.clientY);
    down = null;
  });
}
