import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { type Browser, type BrowserContextOptions, chromium, type Page } from 'playwright-core';
import type { Viewer } from '../../src/viewer';
import { PAGE_URL } from './processes';

const PICTURES = process.env.PLANEMAP_ARTEFACTS ?? 'test-results';

declare global {
  interface Window {
    planemapViewer: Viewer;
  }
}

/** Debian's Chromium without a window, drawing WebGL by software. */
export function launch(): Promise<Browser> {
  return chromium.launch({
    executablePath: process.env.PLANEMAP_CHROMIUM ?? '/usr/bin/chromium',
    args: [
      '--no-sandbox', // as root it does not start otherwise; it sees our own page only
      '--use-gl=angle',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      '--ignore-gpu-blocklist',
    ],
  });
}

/** The page, once it has planes. `outside`: requests that went elsewhere; `problems`: what the console complained of. */
export interface OpenPage {
  readonly page: Page;
  readonly outside: string[];
  readonly problems: string[];
  close(): Promise<void>;
}

export async function open(browser: Browser, options: BrowserContextOptions = {}): Promise<OpenPage> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, colorScheme: 'dark', ...options });
  const page = await context.newPage();
  const outside: string[] = [];
  const problems: string[] = [];
  page.on('request', request => {
    if (!request.url().startsWith(PAGE_URL)) outside.push(request.url());
  });
  page.on('pageerror', error => problems.push(error.message));
  page.on('console', message => {
    if (message.type() === 'error') problems.push(message.text());
  });
  await page.goto(PAGE_URL);
  return { page, outside, problems, close: () => context.close() };
}

export async function untilPlanes(page: Page, least: number): Promise<void> {
  await until(page, count => window.planemapViewer.planes.length >= count, least);
}

/** Waits until it holds in the page. Playwright's own waiting would evaluate text there, which the page's policy forbids. */
export async function until<T>(page: Page, holds: (argument: T) => boolean, argument: T): Promise<void> {
  for (const end = Date.now() + 60_000; Date.now() < end; ) {
    if (await page.evaluate(holds as never, argument)) return;
    await new Promise(resolve => setTimeout(resolve, 50));
  }
  throw new Error(`within a minute it did not come to be: ${holds}`);
}

export const frames = (page: Page): Promise<number> => page.evaluate(() => window.planemapViewer.viewport.frames);

/** Waits until nothing has been drawn for a second. */
export async function untilIdle(page: Page): Promise<void> {
  await page.evaluate(async () => {
    const { viewport } = window.planemapViewer;
    for (let before = -1; before !== viewport.frames; ) {
      before = viewport.frames;
      await new Promise(resolve => setTimeout(resolve, 1000));
    }
  });
}

/** Keeps a picture of the page at rest. */
export async function picture(page: Page, name: string): Promise<void> {
  await untilIdle(page);
  mkdirSync(PICTURES, { recursive: true });
  await page.screenshot({ path: join(PICTURES, `${name}.png`) });
}

/** A point of the page at which a click meets the plane: its centroid, if nothing else is before it. */
export async function pointOf(page: Page, id: number): Promise<{ x: number; y: number } | null> {
  return page.evaluate(wanted => {
    const { map, viewport, scene } = window.planemapViewer;
    const plane = map.plane(wanted);
    if (!plane) return null;
    const point = viewport.project(plane.centroid);
    const onCanvas = document.elementFromPoint(point.x, point.y)?.id === 'view';
    return onCanvas && scene.pick(point.x, point.y)?.id === wanted ? point : null;
  }, id);
}
