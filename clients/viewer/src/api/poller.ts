/** Fetches again when told that there is news: one at a time, not more often than a period; news meanwhile count once. */
export class Poller {
  private wanted = false;
  private busy = false;

  constructor(
    private readonly period_ms: number,
    private readonly fetchOnce: () => Promise<void>,
  ) {}

  want(): void {
    this.wanted = true;
    if (!this.busy) void this.run();
  }

  private async run(): Promise<void> {
    this.busy = true;
    while (this.wanted) {
      this.wanted = false;
      try {
        await this.fetchOnce();
      } catch (error) {
        console.warn('planemap:', error instanceof Error ? error.message : error); // the next news asks again
      }
      await new Promise(resolve => window.setTimeout(resolve, this.period_ms));
    }
    this.busy = false;
  }
}
