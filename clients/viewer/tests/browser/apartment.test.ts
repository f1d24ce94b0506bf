import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import type { PlanesDocument } from '../../src/api/planes';
import { measure } from '../../src/map/measure';
import { frames, launch, type OpenPage, open, picture, pointOf, until, untilIdle, untilPlanes } from './browser';
import { ask, Daemon, feed, PAGE_URL, untilMapped } from './processes';

const SCANS = 450;
const tour = ['--simulate', 'apartment', '--frames', `${SCANS}`, '--time-lapse', '5', '--rate', '20'];

describe('the page with an apartment', () => {
  let daemon: Daemon;
  let browser: Browser;
  let opened: OpenPage;
  let page: Page;
  let planes: PlanesDocument['planes'];

  beforeAll(async () => {
    daemon = await Daemon.start();
    browser = await launch();
    opened = await open(browser);
    page = opened.page;
    await feed(...tour);
    await untilMapped(SCANS);
    planes = (await ask<PlanesDocument>('planes')).planes;
    expect(planes.length).toBeGreaterThan(25);
    await until(page, count => window.planemapViewer.planes.length === count, planes.length);
  });
  afterAll(async () => {
    await browser?.close();
    await daemon?.stop();
  });

  /** Planes that can be clicked, the largest first. */
  async function clickable(): Promise<{ id: number; x: number; y: number }[]> {
    const found = [];
    for (const { id } of [...planes].sort((a, b) => b.area - a.area)) {
      const point = await pointOf(page, id);
      if (point) found.push({ id, ...point });
    }
    expect(found.length).toBeGreaterThan(3);
    return found;
  }

  const field = (name: string) => page.locator(`#inspector [data-field="${name}"]`).innerText();

  it('shows what the daemon has, live', async () => {
    await expect.poll(() => page.locator('#facts').innerText()).toContain(`${planes.length} planes`);
    const shown = await page.evaluate(() => window.planemapViewer.planes.map(plane => plane.id).sort((a, b) => a - b));
    expect(shown).toEqual(planes.map(plane => plane.id).sort((a, b) => a - b));
    await picture(page, 'apartment');
  });

  it('draws planes, not an empty canvas', async () => {
    const [target] = await clickable();
    await untilIdle(page);
    const around = { x: Math.round(target!.x) - 2, y: Math.round(target!.y) - 2, width: 4, height: 4 };
    const before = await page.screenshot({ clip: around });
    await page.keyboard.press('p');
    await page.keyboard.press('o');
    await untilIdle(page);
    expect(before.equals(await page.screenshot({ clip: around }))).toBe(false);
    await page.keyboard.press('p');
    await page.keyboard.press('o');
  });

  it('draws nothing when nothing happens', async () => {
    await untilIdle(page);
    const before = await frames(page);
    await page.waitForTimeout(4000); // what is looked at, not waited for: four status events come meanwhile
    expect(await frames(page)).toBe(before);
  });

  it('tells of a plane that is clicked', async () => {
    const [target] = await clickable();
    await page.mouse.click(target!.x, target!.y);
    const plane = planes.find(({ id }) => id === target!.id)!;
    await expect.poll(() => page.locator('#inspector h2').innerText()).toBe(`Plane ${plane.id}`);
    expect(await field('class')).toBe(plane.class);
    expect(Number.parseFloat(await field('area'))).toBeCloseTo(plane.area, 1);
    expect(await field('normal')).toContain('±');
    expect(await field('offset')).toMatch(/m ± [\d.]+ mm$/);
    expect((await field('points')).replace(/\D/g, '')).toBe(String(plane.pointCount));
    expect(await field('last-seen')).toContain('last scan');
    await picture(page, 'selected');
    await page.keyboard.press('Escape');
    expect(await page.locator('#inspector').isHidden()).toBe(true);
  });

  it('measures between two planes that are clicked', async () => {
    const [a, b] = await clickable();
    await page.click('#measure');
    await page.mouse.click(a!.x, a!.y);
    await expect.poll(() => page.locator('#hint').innerText()).toBe('Choose the second plane');
    await page.mouse.click(b!.x, b!.y);
    await expect.poll(() => page.locator('#inspector h2').innerText()).toBe(`Plane ${a!.id} to plane ${b!.id}`);
    const record = (id: number) => ({ ...planes.find(plane => plane.id === id)!, coplanarWith: [] });
    const { distance, angle } = measure(record(a!.id), record(b!.id));
    expect(Number.parseFloat(await field('distance'))).toBeCloseTo(distance.value, 2);
    expect(Number.parseFloat(await field('angle'))).toBeCloseTo((angle.value * 180) / Math.PI, 1);
    expect(await field('distance')).toContain('±');
    await picture(page, 'measured');
    await page.keyboard.press('Escape');
  });

  it('filters by class, area and deviation', async () => {
    const shown = () => page.evaluate(() => window.planemapViewer.planes.length);
    await page.click('[data-class="wall"]');
    await expect.poll(shown).toBe(planes.filter(plane => plane.class !== 'wall').length);
    await page.click('[data-class="wall"]');
    await page.focus('#least-area');
    for (let step = 0; step < 4; ++step) await page.keyboard.press('ArrowRight'); // 0.1, 0.2, 0.5, 1 m2
    await expect.poll(shown).toBe(planes.filter(plane => plane.area >= 1).length);
    await page.keyboard.press('Home');
    await page.focus('#largest-deviation');
    for (let step = 0; step < 7; ++step) await page.keyboard.press('ArrowLeft'); // 5, 2, 1, 0.5, 0.2, 0.1, 0.05 degrees
    const deviations = planes.map(plane => (plane.normalDeviation * 180) / Math.PI);
    await expect.poll(shown).toBe(deviations.filter(degrees => degrees <= 0.05).length);
    await page.keyboard.press('End');
    await expect.poll(shown).toBe(planes.length);
  });

  it('colours by class and by uncertainty, with scales in degrees and millimetres', async () => {
    const legend = () => page.locator('#legend').innerText();
    await page.click('[data-value="class"]');
    expect(await legend()).toMatch(/class/i);
    await page.click('[data-value="normal"]');
    expect(await legend()).toMatch(/\d°/);
    await picture(page, 'by-normal');
    await page.click('[data-value="offset"]');
    expect(await legend()).toMatch(/\d mm/);
    await page.click('[data-value="plane"]');
  });

  it('shows cells by the deviation of their normals, the scan and the cones of a plane', async () => {
    await page.click('[data-layer="cells"]');
    await until(page, () => window.planemapViewer.scene.drawnCells > 10_000, null);
    await page.click('[data-layer="scan"]');
    await picture(page, 'cells');
    await page.keyboard.press('n');
    await until(page, () => window.planemapViewer.scene.drawnCones > 100, null);
    await page.click('[data-layer="cells"]');
    await page.click('[data-layer="scan"]');
    const table = planes.filter(plane => plane.class === 'table').sort((a, b) => b.area - a.area)[0]!;
    await page.evaluate(id => window.planemapViewer.choose(id), table.id);
    await page.keyboard.press('z');
    await until(page, () => window.planemapViewer.scene.drawnCones > 10, null);
    await picture(page, 'cones');
    await page.keyboard.press('f');
    await page.keyboard.press('Escape');
  });

  it('has a floor plan with a scale bar that is true', async () => {
    await page.keyboard.press('v');
    await picture(page, 'plan');
    const bar = await page.locator('#scalebar-line').boundingBox();
    const metres = Number.parseFloat(await page.locator('#scalebar-text').innerText());
    const ends = await page.evaluate(() => {
      const { viewport } = window.planemapViewer;
      return [viewport.project([0, 0, 0]).x, viewport.project([1, 0, 0]).x];
    });
    expect(bar!.width / metres).toBeCloseTo(ends[1]! - ends[0]!, 0);
    await page.keyboard.press('v');
    expect(await page.locator('#scalebar').isHidden()).toBe(true);
  });

  it.each(['ply', 'obj', 'json', 'svg'])('downloads %s', async extension => {
    const [download] = await Promise.all([
      page.waitForEvent('download'),
      page.click(`.downloads a[href$=".${extension}"]`),
    ]);
    expect(download.suggestedFilename()).toBe(`planes.${extension}`);
    expect(await download.failure()).toBeNull();
  });

  it('shows the licences of what is bundled', async () => {
    await page.click('#show-licenses');
    await expect.poll(() => page.locator('#licenses-dialog pre').innerText()).toContain('three');
    expect(await page.locator('#licenses-dialog pre').innerText()).toContain('MIT');
    await page.keyboard.press('Escape');
  });

  it('is used by keyboard alone', async () => {
    await page.keyboard.press('?');
    expect(await page.locator('#help-dialog').isVisible()).toBe(true);
    await picture(page, 'help');
    await page.keyboard.press('Escape');
    const before = await frames(page);
    await page.keyboard.press('ArrowLeft');
    await until(page, n => window.planemapViewer.viewport.frames > n, before);
    await page.keyboard.press('l');
    await page.locator('#planes li button').first().focus();
    await page.keyboard.press('Enter');
    await expect.poll(() => page.locator('#inspector h2').innerText()).toMatch(/^Plane \d+$/);
    await picture(page, 'list');
    await page.keyboard.press('Escape');
    await page.keyboard.press('h');
  });

  it('is light where the system is', async () => {
    await page.emulateMedia({ colorScheme: 'light' });
    await expect.poll(() => page.locator('html').getAttribute('data-theme')).toBe('light');
    await page.keyboard.press('f');
    await picture(page, 'light');
    await page.emulateMedia({ colorScheme: 'dark' });
  });

  it('fits a phone and is used by touch', async () => {
    const phone = await open(browser, {
      viewport: { width: 390, height: 780 },
      deviceScaleFactor: 2,
      hasTouch: true,
      isMobile: true,
    });
    await untilPlanes(phone.page, planes.length);
    expect(await phone.page.evaluate(() => document.documentElement.scrollWidth)).toBe(390);
    await picture(phone.page, 'phone');
    await phone.page.tap('.tabs [data-panel="planes"]');
    await phone.page.locator('#planes li button').first().tap();
    await expect.poll(() => phone.page.locator('#inspector h2').innerText()).toMatch(/^Plane \d+$/);
    await phone.page.tap('.tabs [data-panel="planes"]');
    await picture(phone.page, 'phone-selected');
    expect(phone.problems).toEqual([]);
    await phone.close();
  });

  it('holds still while it is paused', async () => {
    const revision = () => page.evaluate(() => window.planemapViewer.map.shown.revision);
    await page.keyboard.press(' ');
    const before = await revision();
    await feed('--simulate', 'apartment', '--seed', '2', '--frames', '10', '--rate', '20');
    await untilMapped(SCANS + 10);
    await until(page, was => window.planemapViewer.map.revision > was, before);
    expect(await revision()).toBe(before);
    await expect.poll(() => page.locator('#hint').innerText()).toMatch(/Paused, \d+ revisions? behind/);
    await page.keyboard.press(' ');
    await expect.poll(revision).toBeGreaterThan(before);
  });

  it('asked nothing of anybody but the daemon, and had nothing to complain of', () => {
    expect(opened.outside).toEqual([]);
    expect(opened.problems).toEqual([]);
  });

  it('says when the daemon is gone and since when, and goes on when it is back', async () => {
    await daemon.stop('SIGKILL');
    await expect.poll(() => page.locator('#banner').isVisible()).toBe(true);
    expect(await page.locator('#banner-text').innerText()).toMatch(/has not answered since \d\d:\d\d:\d\d/);
    expect(await page.locator('#connection').innerText()).toMatch(/Gone since \d\d:\d\d:\d\d/);
    await picture(page, 'gone');
    daemon = await Daemon.start();
    await page.click('#retry');
    await expect.poll(() => page.locator('#banner').isHidden(), { timeout: 15_000 }).toBe(true);
    await expect.poll(() => page.evaluate(() => window.planemapViewer.planes.length)).toBe(0); // another map
    await feed('--simulate', 'apartment', '--frames', '40', '--time-lapse', '5', '--rate', '20');
    await untilPlanes(page, 3);
  });

  it('comes back by itself', async () => {
    await daemon.stop();
    await expect.poll(() => page.locator('#banner').isVisible()).toBe(true);
    daemon = await Daemon.start();
    await expect.poll(() => page.locator('#banner').isHidden(), { timeout: 20_000 }).toBe(true);
    expect((await page.goto(PAGE_URL))?.status()).toBe(200);
  });
});
