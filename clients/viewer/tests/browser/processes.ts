import { type ChildProcess, spawn } from 'node:child_process';
import { once } from 'node:events';
import { join } from 'node:path';

const BIN_DIR = process.env.PLANEMAP_BIN_DIR ?? '';
const LCM_URL = 'udpm://239.255.76.67:7667?ttl=0';
export const PAGE_URL = 'http://127.0.0.1:7671/'; // of a network of our own: nobody else has the port
const START_MS = 20_000;

/** A program of the project, and all it said. */
class Program {
  said = '';
  readonly process: ChildProcess;
  private readonly ended: Promise<unknown>;

  constructor(name: string, ...args: string[]) {
    this.process = spawn(join(BIN_DIR, name), [...args, '--lcm-url', LCM_URL], { stdio: ['ignore', 'pipe', 'pipe'] });
    for (const stream of [this.process.stdout!, this.process.stderr!]) {
      stream.on('data', chunk => {
        this.said += chunk;
      });
    }
    this.ended = once(this.process, 'exit');
  }

  /** Waits for its end. @throws Error with what it said unless it ended well */
  async finish(): Promise<void> {
    await this.ended;
    if (this.process.exitCode !== 0) throw new Error(`ended with ${this.process.exitCode}: ${this.said}`);
  }

  async kill(signal: NodeJS.Signals): Promise<void> {
    if (this.process.exitCode === null && this.process.signalCode === null) {
      this.process.kill(signal);
      await this.ended;
    }
  }

  get isRunning(): boolean {
    return this.process.exitCode === null && this.process.signalCode === null;
  }
}

/** planemapd on the loopback, ready to answer. Its queue is long: on a busy machine scans wait, and none is lost. */
export class Daemon {
  private constructor(private readonly program: Program) {}

  static async start(...settings: string[]): Promise<Daemon> {
    const daemon = new Daemon(
      new Program(
        'planemapd',
        ...['map.gravity=[0, 0, -1]', 'queue.scans=400', ...settings].flatMap(setting => ['--set', setting]),
      ),
    );
    const end = Date.now() + START_MS;
    while (!(await isReady())) {
      if (!daemon.program.isRunning) throw new Error(`planemapd ended: ${daemon.program.said}`);
      if (Date.now() > end) throw new Error(`planemapd is not ready: ${daemon.program.said}`);
      await new Promise(resolve => setTimeout(resolve, 50));
    }
    return daemon;
  }

  async stop(signal: NodeJS.Signals = 'SIGTERM'): Promise<void> {
    await this.program.kill(signal);
  }
}

async function isReady(): Promise<boolean> {
  try {
    return (await fetch(`${PAGE_URL}readyz`)).ok;
  } catch {
    return false;
  }
}

/** Has the simulated Kinect, or a folder's frames, go over LCM; returns when all were sent. */
export async function feed(...args: string[]): Promise<void> {
  await new Program('planemap-kinect-bridge', '--quiet', ...args).finish();
}

export async function ask<T>(path: string): Promise<T> {
  const response = await fetch(`${PAGE_URL}api/v1/${path}`);
  if (!response.ok) throw new Error(`${path}: ${response.status}`);
  return (await response.json()) as T;
}

/** Waits until the daemon has mapped so many scans. @throws Error if any was dropped or they do not come */
export async function untilMapped(scans: number): Promise<void> {
  const end = Date.now() + 60_000;
  for (;;) {
    const { counters } = await ask<{ counters: Record<string, number> }>('status');
    if ((counters['scans.mapped'] ?? 0) >= scans) return;
    if (Date.now() > end) throw new Error(`not all ${scans} scans were mapped: ${JSON.stringify(counters, null, 1)}`);
    await new Promise(resolve => setTimeout(resolve, 50));
  }
}
