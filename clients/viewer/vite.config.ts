import { defineConfig } from 'vitest/config';
import { licenses } from './build/licenses';

export default defineConfig({
  base: './',
  plugins: [licenses()],
  build: {
    target: 'es2022',
    sourcemap: false,
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 800,
  },
  // `npm run dev` shows the map of a daemon that runs here: PLANEMAP_HTTP=http://127.0.0.1:7671
  server: {
    host: '127.0.0.1',
    proxy: { '/api': { target: process.env.PLANEMAP_HTTP ?? 'http://127.0.0.1:7671', changeOrigin: true } },
  },
  test: { include: ['tests/unit/**/*.test.ts'] },
});
