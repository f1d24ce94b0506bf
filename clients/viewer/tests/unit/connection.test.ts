import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { backOff_ms, Connection, type ConnectionState, SILENCE_MS } from '../../src/api/connection';

/** Stands in for the browser's EventSource: the tests say what the daemon says. */
class FakeEventSource extends EventTarget {
  static opened: FakeEventSource[] = [];
  onerror: (() => void) | null = null;
  closed = false;
  constructor(readonly url: string) {
    super();
    FakeEventSource.opened.push(this);
  }
  close(): void {
    this.closed = true;
  }
  say(name: string, data: unknown): void {
    this.dispatchEvent(new MessageEvent(name, { data: typeof data === 'string' ? data : JSON.stringify(data) }));
  }
}

const hello = { epoch: 1, revision: 2, frame: 'world', version: '1' };
const delta = { epoch: 1, revision: 2, since: 0, full: true, planes: [], removed: [], blocksChanged: 0 };

describe('Connection', () => {
  let states: ConnectionState[] = [];
  const handlers = {
    state: (s: ConnectionState) => states.push(s),
    hello: vi.fn(),
    delta: vi.fn(),
    pose: vi.fn(),
    status: vi.fn(),
  };
  const newest = () => FakeEventSource.opened.at(-1)!;

  beforeEach(() => {
    states = [];
    FakeEventSource.opened = [];
    vi.useFakeTimers();
    vi.stubGlobal('EventSource', FakeEventSource);
    vi.stubGlobal('window', globalThis);
    new Connection('events', handlers).open();
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
    vi.resetAllMocks();
  });

  it('is live after hello', () => {
    newest().say('hello', hello);
    newest().say('delta', delta);
    expect(states).toEqual([{ kind: 'live' }]);
    expect(handlers.delta).toHaveBeenCalledOnce();
  });

  it('says since when the daemon is gone, and opens again after a while', () => {
    newest().say('hello', hello);
    const heard = Date.now();
    vi.advanceTimersByTime(3000);
    newest().onerror!();
    expect(states.at(-1)).toMatchObject({ kind: 'gone', since_ms: heard, reason: 'the connection ended' });
    expect(newest().closed).toBe(true);
    vi.advanceTimersByTime(600);
    expect(FakeEventSource.opened).toHaveLength(2);
    newest().say('hello', hello);
    expect(states.at(-1)).toEqual({ kind: 'live' });
  });

  it('does not wait for a daemon that is silent', () => {
    newest().say('hello', hello);
    vi.advanceTimersByTime(SILENCE_MS - 1);
    expect(states.at(-1)!.kind).toBe('live');
    vi.advanceTimersByTime(1);
    expect(states.at(-1)).toMatchObject({ kind: 'gone', reason: 'nothing was heard for 6 s' });
  });

  it.each([
    ['no JSON', '{', 'JSON'],
    ['a wrong type', { ...delta, planes: 5 }, 'delta.planes: no array'],
  ])('begins anew when it does not understand: %s', (_what, data, message) => {
    newest().say('delta', data);
    expect(states.at(-1)!.kind).toBe('gone');
    expect((states.at(-1) as { reason: string }).reason).toContain(message);
  });
});

describe('backOff_ms', () => {
  it('doubles up to a limit', () => {
    expect([0, 1, 2, 3, 4, 5, 100].map(n => backOff_ms(n, 0.5))).toEqual([500, 1000, 2000, 4000, 8000, 8000, 8000]);
  });
  it('spreads the pages that wait', () => expect([backOff_ms(0, 0), backOff_ms(0, 1)]).toEqual([400, 600]));
});
