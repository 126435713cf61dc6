/** Blocks, chunks and cells: PROTOCOL.md, Levels. */
import type { Triple } from "../protocol/frames";

export const BLOCK = 64;
export const CHUNK = 16;

/** A block of cells of 2^level voxels. */
export interface BlockId {
  level: number;
  index: Triple;
}

export type BlockKey = number;
const HALF = 1 << 15;

/** One number per block, for maps. @pre index within 2^15, which no map of 100 km exceeds. */
export function keyOf(level: number, [x, y, z]: Triple): BlockKey {
  return ((level * 65536 + (x + HALF)) * 65536 + (y + HALF)) * 65536 + (z + HALF);
}

export const inReach = (index: Triple): boolean => index.every((i) => i >= -HALF && i < HALF);

/** Edge of a cell, in units of a voxel's. */
export const cellScale = (level: number): number => 2 ** level;

/** The chunk of a block that holds a cell, and the cell's bit in it; x, y, z count from the block's corner. */
export const chunkOf = (x: number, y: number, z: number): number => (x >> 4) + 4 * (y >> 4) + 16 * (z >> 4);
export const bitOf = (x: number, y: number, z: number): number => (x & 15) + 16 * (y & 15) + 256 * (z & 15);
