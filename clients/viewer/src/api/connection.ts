import { DecodeError } from './check';
import { type Delta, deltaAt, type Hello, helloAt, type Pose, poseAt, type Status, statusAt } from './events';

export type ConnectionState =
  | { readonly kind: 'connecting' }
  | { readonly kind: 'live' }
  | { readonly kind: 'gone'; readonly since_ms: number; readonly nextTry_ms: number; readonly reason: string };

export interface ConnectionHandlers {
  state(state: ConnectionState): void;
  hello(hello: Hello): void;
  delta(delta: Delta): void;
  pose(pose: Pose): void;
  status(status: Status): void;
}

/** The daemon says something every second; after so long a silence it is taken to be gone. */
export const SILENCE_MS = 6000;
const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;

/** Waits before the next try: twice as long each time, a little apart for each page so that not all come at once. */
export function backOff_ms(failures: number, random: number): number {
  return Math.round(Math.min(LONGEST_WAIT_MS, FIRST_WAIT_MS * 2 ** Math.min(failures, 10)) * (0.8 + 0.4 * random));
}

/** The stream of events, opened again whenever it ends. */
export class Connection {
  private source: EventSource | null = null;
  private watchdog = 0;
  private retry = 0;
  private failures = 0;
  private lastHeard_ms = Date.now();

  constructor(
    private readonly url: string,
    private readonly handlers: ConnectionHandlers,
  ) {}

  open(): void {
    this.close();
    const source = new EventSource(this.url);
    this.source = source;
    source.onerror = () => this.lost('the connection ended');
    this.listen(source, 'hello', data => {
      const hello = helloAt(data);
      this.handlers.state({ kind: 'live' });
      this.handlers.hello(hello);
    });
    this.listen(source, 'delta', data => {
      this.handlers.delta(deltaAt(data));
      this.failures = 0; // a stream that works, not only one that opens
    });
    this.listen(source, 'pose', data => this.handlers.pose(poseAt(data)));
    this.listen(source, 'status', data => this.handlers.status(statusAt(data)));
    this.watch();
  }

  close(): void {
    this.source?.close();
    this.source = null;
    window.clearTimeout(this.watchdog);
    window.clearTimeout(this.retry);
  }

  private listen(source: EventSource, name: string, handle: (data: unknown) => void): void {
    source.addEventListener(name, (event: MessageEvent<string>) => {
      this.lastHeard_ms = Date.now();
      this.watch();
      try {
        handle(JSON.parse(event.data));
      } catch (error) {
        // Errors of the wire, and gaps: begin anew with all there is. Others are faults of this page.
        if (!(error instanceof DecodeError || error instanceof SyntaxError)) throw error;
        this.lost(`what it said is not understood (${error.message})`);
      }
    });
  }

  private watch(): void {
    window.clearTimeout(this.watchdog);
    this.watchdog = window.setTimeout(() => this.lost(`nothing was heard for ${SILENCE_MS / 1000} s`), SILENCE_MS);
  }

  private lost(reason: string): void {
    this.close();
    const wait_ms = backOff_ms(this.failures++, Math.random());
    this.retry = window.setTimeout(() => this.open(), wait_ms);
    this.handlers.state({ kind: 'gone', since_ms: this.lastHeard_ms, nextTry_ms: Date.now() + wait_ms, reason });
  }
}
