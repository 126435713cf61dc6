/** Labelled voxels as two layers of blocks: what people labelled by hand, and what assets brought. */
import type { BlockFrame, ForgetFrame, LabelsFrame, Triple } from "../protocol/frames";
import { BlockStore } from "./block_store";
import { bitOf, chunkOf, keyOf } from "./lattice";

export class LabelBlocks {
  readonly manual = new BlockStore();
  readonly assets = new BlockStore();
  private readonly frames = new Map<number, LabelsFrame>();
  private assetThings: ReadonlySet<string> = new Set();

  apply(frame: LabelsFrame | ForgetFrame): void {
    if (frame.kind === "forget") {
      for (const index of frame.blocks) this.frames.delete(keyOf(frame.level, index));
      this.manual.apply(frame);
      this.assets.apply(frame);
      return;
    }
    this.frames.set(keyOf(frame.level, frame.index), frame);
    this.fill(frame);
  }

  clear(): void {
    this.frames.clear();
    this.manual.clear();
    this.assets.clear();
  }

  /** Which things are assets; the others are manual labels. */
  setAssets(things: readonly { label: number; instance: number }[]): void {
    this.assetThings = new Set(things.map(nameOf));
    this.frames.forEach((frame) => this.fill(frame));
  }

  /** The thing that a voxel belongs to. */
  at(voxel: Triple): { label: number; instance: number } | null {
    const frame = this.frames.get(keyOf(0, voxel.map((v) => v >> 6) as Triple));
    if (!frame) return null;
    const [x, y, z] = voxel.map((v) => v & 63) as Triple;
    const cell = x + 64 * y + 4096 * z;
    const run = frame.runs.find(({ start, length }) => cell >= start && cell < start + length);
    return run ? frame.things[run.thing]! : null;
  }

  private fill(frame: LabelsFrame): void {
    const manual = new Map<number, Uint8Array>();
    const assets = new Map<number, Uint8Array>();
    for (const { start, length, thing } of frame.runs) {
      const into = this.assetThings.has(nameOf(frame.things[thing]!)) ? assets : manual;
      for (let cell = start; cell < start + length; ++cell) setCell(into, cell);
    }
    this.manual.apply(whole(frame, manual));
    this.assets.apply(whole(frame, assets));
  }
}

const nameOf = ({ label, instance }: { label: number; instance: number }): string => `${label}/${instance}`;

function setCell(chunks: Map<number, Uint8Array>, cell: number): void {
  const at: Triple = [cell & 63, (cell >> 6) & 63, cell >> 12];
  const chunk = chunkOf(...at);
  let cells = chunks.get(chunk);
  if (!cells) chunks.set(chunk, (cells = new Uint8Array(512)));
  cells[bitOf(...at) >> 3]! |= 1 << (bitOf(...at) & 7);
}

function whole({ stream, level, index }: LabelsFrame, filled: Map<number, Uint8Array>): BlockFrame {
  const chunks = Array.from({ length: 64 }, (_, chunk) => ({ chunk, cells: filled.get(chunk) ?? null }));
  return { kind: "block", stream, level, index, revision: 0, chunks };
}
