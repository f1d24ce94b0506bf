import { CELL_FLOATS, type CellBlock, type CellsUpdate } from '../api/binary';

/** The cells that are known, by block. */
export class CellStore {
  epoch = 0;
  revision = 0;
  count = 0;
  private readonly blocks = new Map<string, CellBlock>();

  /** Returns false, and knows nothing any more, if the update goes on from another map than is known: ask for all then. */
  apply(update: CellsUpdate): boolean {
    if (update.full) this.clear();
    else if (update.epoch !== this.epoch) {
      this.clear();
      return false;
    }
    for (const block of update.blocks) {
      this.count += block.planeIds.length - (this.blocks.get(block.key)?.planeIds.length ?? 0);
      if (block.planeIds.length === 0) this.blocks.delete(block.key);
      else this.blocks.set(block.key, block);
    }
    this.epoch = update.epoch;
    this.revision = update.revision;
    return true;
  }

  clear(): void {
    this.blocks.clear();
    this.count = 0;
    this.revision = 0;
  }

  /** Calls for each cell with the block's numbers, where the cell's begin there, and the cell's plane. */
  forEach(visit: (values: Float32Array, at: number, planeId: number) => void): void {
    for (const { values, planeIds } of this.blocks.values()) {
      for (let cell = 0; cell < planeIds.length; ++cell) visit(values, cell * CELL_FLOATS, planeIds[cell]!);
    }
  }
}

/**
 * An order of `count` things in which each beginning is spread evenly over all: the thing at place i goes to place
 * (i * stride) mod count. The stride is the golden section's share of the count, made coprime to it.
 */
export function spreadStride(count: number): number {
  const gcd = (a: number, b: number): number => (b === 0 ? a : gcd(b, a % b));
  let stride = Math.max(1, Math.round(count * 0.6180339887));
  while (gcd(stride, count) !== 1) ++stride;
  return stride;
}
