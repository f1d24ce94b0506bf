import { defineConfig } from 'vitest/config';

// Run by tests/browser/run.sh, in a network of its own.
export default defineConfig({
  test: {
    include: ['tests/browser/**/*.test.ts'],
    fileParallelism: false, // one machine's speed is measured
    testTimeout: 120_000,
    hookTimeout: 180_000,
    expect: { poll: { timeout: 10_000 } },
  },
});
