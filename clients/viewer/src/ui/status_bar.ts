import type { ConnectionState } from '../api/connection';
import type { Status } from '../api/events';
import { byId, setText } from './dom';
import { clock, count, duration } from './format';

/** Whether the daemon is there, and what it does. */
export class StatusBar {
  private state: ConnectionState = { kind: 'connecting' };
  private status: Status | null = null;
  private timer = 0;

  constructor(retry: () => void) {
    byId('retry').addEventListener('click', retry);
  }

  setState(state: ConnectionState): void {
    this.state = state;
    window.clearInterval(this.timer);
    if (state.kind === 'gone') this.timer = window.setInterval(() => this.show(), 1000);
    this.show();
  }

  setStatus(status: Status): void {
    this.status = status;
    this.show();
  }

  private show(): void {
    const { state } = this;
    byId('connection').dataset.state = state.kind === 'live' && this.status?.idleReason ? 'idle' : state.kind;
    const banner = byId('banner');
    banner.hidden = state.kind !== 'gone';
    setText(byId('facts'), state.kind === 'gone' ? '' : this.facts());
    if (state.kind === 'gone') {
      const wait_s = Math.max(0, Math.ceil((state.nextTry_ms - Date.now()) / 1000));
      const next = wait_s > 0 ? `Next try in ${wait_s} s.` : 'Trying now.';
      const silent = duration((Date.now() - state.since_ms) / 1000);
      setText(byId('connection-text'), `Gone since ${clock(state.since_ms)}`);
      setText(
        byId('banner-text'),
        `planemapd has not answered since ${clock(state.since_ms)} (${silent}): ${state.reason}. ` +
          `The map is shown as it was then. ${next}`,
      );
    } else if (state.kind === 'live') {
      setText(byId('connection-text'), this.status?.idleReason ? 'Idle' : 'Live');
    } else {
      setText(byId('connection-text'), 'Connecting');
    }
    byId('connection').title = this.status?.idleReason ?? '';
  }

  private facts(): string {
    if (!this.status) return '';
    const { planeCount, cellCount, scanRateHz, idleReason } = this.status;
    const rate = idleReason ? idleReason : `${scanRateHz.toFixed(1)} scans/s`;
    return `${count(planeCount)} planes \u00b7 ${count(cellCount)} cells \u00b7 ${rate}`;
  }
}
