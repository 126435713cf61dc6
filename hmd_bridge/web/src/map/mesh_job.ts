/** One block to be meshed, packed for the way to a worker, and what comes back. */
import type { Block } from "./block_store";
import type { Triple } from "../protocol/frames";
import { bitOf, BLOCK, chunkOf } from "./lattice";
import { greedyQuads, quadGeometry, type QuadGeometry } from "./greedy";

export interface MeshJob {
  job: number;
  /** Numbers of the filled chunks, and 512 bytes for each. */
  chunks: Uint8Array<ArrayBuffer>;
  cells: Uint8Array<ArrayBuffer>;
  /** Occupied cells beyond each face, 64 x 64 bits, in the order of faces of greedy.ts; the axes are (axis + 1) % 3, (axis + 2) % 3. */
  borders: Uint8Array<ArrayBuffer>;
}
export interface MeshDone extends QuadGeometry {
  job: number;
}

const BORDER_BYTES = (BLOCK * BLOCK) / 8;

/** @param find the block of the same level with this index, if there is one. */
export function packJob(job: number, block: Block, find: (index: Triple) => Block | undefined): MeshJob {
  const chunks = Uint8Array.from(block.chunks.keys());
  const cells = new Uint8Array(chunks.length * 512);
  chunks.forEach((chunk, i) => cells.set(block.chunks.get(chunk)!, i * 512));
  const borders = new Uint8Array(6 * BORDER_BYTES);
  for (let face = 0; face < 6; ++face) {
    const axis = face >> 1;
    const up = face & 1;
    const index: Triple = [...block.index];
    index[axis]! += up ? 1 : -1;
    const neighbour = find(index);
    if (neighbour) packBorder(borders.subarray(face * BORDER_BYTES, (face + 1) * BORDER_BYTES), neighbour, axis, up ? 0 : BLOCK - 1);
  }
  return { job, chunks, cells, borders };
}

function packBorder(out: Uint8Array, block: Block, axis: number, depth: number): void {
  const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
  const at: Triple = [0, 0, 0];
  at[axis] = depth;
  for (let b = 0; b < BLOCK; ++b) {
    for (let a = 0; a < BLOCK; ++a) {
      at[u] = a;
      at[v] = b;
      const bit = bitOf(...at);
      const cells = block.chunks.get(chunkOf(...at));
      if (cells && (cells[bit >> 3]! >> (bit & 7)) & 1) out[(b * BLOCK + a) >> 3]! |= 1 << (a & 7);
    }
  }
}

/** The cells of a job with one layer around, a byte each, as greedyQuads takes them. */
export function unpackJob({ chunks, cells, borders }: MeshJob): Uint8Array {
  const padded = BLOCK + 2;
  const strides = [1, padded, padded * padded] as const;
  const out = new Uint8Array(padded ** 3);
  chunks.forEach((chunk, i) => {
    const corner = ((chunk & 3) * 16 + 1) * strides[0] + (((chunk >> 2) & 3) * 16 + 1) * strides[1] + ((chunk >> 4) * 16 + 1) * strides[2];
    for (let byte = 0; byte < 512; ++byte) {
      const bits = cells[i * 512 + byte]!;
      if (!bits) continue;
      const first = corner + (byte & 1) * 8 + ((byte >> 1) & 15) * strides[1] + (byte >> 5) * strides[2];
      for (let x = 0; x < 8; ++x) out[first + x] = (bits >> x) & 1;
    }
  });
  for (let face = 0; face < 6; ++face) {
    const axis = face >> 1;
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    const start = (face & 1 ? BLOCK + 1 : 0) * strides[axis]! + strides[u]! + strides[v]!;
    for (let cell = 0; cell < BLOCK * BLOCK; ++cell) {
      if (!((borders[face * BORDER_BYTES + (cell >> 3)]! >> (cell & 7)) & 1)) continue;
      out[start + (cell & (BLOCK - 1)) * strides[u]! + (cell >> 6) * strides[v]!] = 1;
    }
  }
  return out;
}

export function doJob(job: MeshJob): MeshDone {
  return { job: job.job, ...quadGeometry(greedyQuads(unpackJob(job), BLOCK)) };
}
