/** What a client holds of one layer: the occupied cells of the blocks in view, as frames tell of them. */
import type { BlockFrame, ForgetFrame, Triple } from "../protocol/frames";
import { bitOf, BLOCK, chunkOf, inReach, keyOf, type BlockId, type BlockKey } from "./lattice";

export interface Block extends BlockId {
  key: BlockKey;
  /** By number of the chunk. Never empty. */
  chunks: Map<number, Uint8Array>;
}

const kDirections: readonly Triple[] = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];

export class BlockStore {
  private readonly blocks = new Map<BlockKey, Block>();
  private readonly dirty = new Map<BlockKey, BlockId>();
  private readonly levels = new Set<number>();

  get size(): number {
    return this.blocks.size;
  }

  find(level: number, index: Triple): Block | undefined {
    return inReach(index) ? this.blocks.get(keyOf(level, index)) : undefined;
  }

  all(): Iterable<Block> {
    return this.blocks.values();
  }

  /** Takes in a frame. Blocks beyond reach are not kept. */
  apply(frame: BlockFrame | ForgetFrame): void {
    if (frame.kind === "forget") {
      for (const index of frame.blocks) this.drop(frame.level, index);
      return;
    }
    const { level, index } = frame;
    if (!inReach(index)) return;
    const key = keyOf(level, index);
    const block = this.blocks.get(key) ?? { key, level, index, chunks: new Map<number, Uint8Array>() };
    for (const { chunk, cells } of frame.chunks) {
      if (cells) block.chunks.set(chunk, cells);
      else block.chunks.delete(chunk);
    }
    if (block.chunks.size > 0) this.blocks.set(key, block);
    else this.blocks.delete(key);
    this.levels.add(level);
    this.touch(level, index);
  }

  /** All is void: the layer began anew. */
  clear(): void {
    for (const block of this.blocks.values()) this.dirty.set(block.key, block);
    this.blocks.clear();
  }

  /** Blocks that look different since the last call: they changed, or a neighbour whose faces they hide did. */
  takeDirty(): BlockId[] {
    const dirty = [...this.dirty.values()];
    this.dirty.clear();
    return dirty;
  }

  /** Whether a voxel lies in an occupied cell, of whichever level is there. */
  occupied(voxel: Triple): boolean {
    for (const level of this.levels) {
      const [x, y, z] = voxel.map((v) => v >> level) as Triple;
      const block = this.find(level, [x >> 6, y >> 6, z >> 6]);
      if (!block) continue;
      const cell: Triple = [x & (BLOCK - 1), y & (BLOCK - 1), z & (BLOCK - 1)];
      const bit = bitOf(...cell);
      const cells = block.chunks.get(chunkOf(...cell));
      if (cells && (cells[bit >> 3]! >> (bit & 7)) & 1) return true;
    }
    return false;
  }

  /** Lowest and highest corner of all blocks, in voxels; null while there are none. */
  bounds(): { low: Triple; high: Triple } | null {
    if (this.blocks.size === 0) return null;
    const low: Triple = [Infinity, Infinity, Infinity];
    const high: Triple = [-Infinity, -Infinity, -Infinity];
    for (const { level, index, chunks } of this.blocks.values()) {
      for (const chunk of chunks.keys()) {
        const at: Triple = [chunk & 3, (chunk >> 2) & 3, chunk >> 4];
        for (let axis = 0; axis < 3; ++axis) {
          const from = (index[axis]! * 4 + at[axis]!) * 16 * 2 ** level;
          low[axis] = Math.min(low[axis]!, from);
          high[axis] = Math.max(high[axis]!, from + 16 * 2 ** level);
        }
      }
    }
    return { low, high };
  }

  private drop(level: number, index: Triple): void {
    if (inReach(index) && this.blocks.delete(keyOf(level, index))) this.touch(level, index);
  }

  private touch(level: number, index: Triple): void {
    this.dirty.set(keyOf(level, index), { level, index });
    for (const [x, y, z] of kDirections) {
      const neighbour = this.find(level, [index[0] + x, index[1] + y, index[2] + z]);
      if (neighbour) this.dirty.set(neighbour.key, neighbour);
    }
  }
}
