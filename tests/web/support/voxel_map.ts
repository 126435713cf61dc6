/** A small map as sets of voxels, and the frames that tell of it: what the double of a server holds. */
import { bitOf, chunkOf } from "../../../hmd_bridge/web/src/map/lattice";
import type { Triple } from "../../../hmd_bridge/web/src/protocol/frames";

const HEADER = 24;

export class VoxelMap {
  private readonly voxels = new Set<string>();

  has(voxel: Triple): boolean {
    return this.voxels.has(voxel.join(","));
  }

  get size(): number {
    return this.voxels.size;
  }

  /** Sets a box of voxels, both corners included; which of them have changed. */
  fill([x0, y0, z0]: Triple, [x1, y1, z1]: Triple, occupied: boolean): Triple[] {
    const changed: Triple[] = [];
    for (let z = z0; z <= z1; ++z) for (let y = y0; y <= y1; ++y) for (let x = x0; x <= x1; ++x) {
      if (this.set([x, y, z], occupied)) changed.push([x, y, z]);
    }
    return changed;
  }

  set(voxel: Triple, occupied: boolean): boolean {
    const name = voxel.join(",");
    if (this.voxels.has(name) === occupied) return false;
    if (occupied) this.voxels.add(name);
    else this.voxels.delete(name);
    return true;
  }

  all(): Triple[] {
    return [...this.voxels].map((name) => name.split(",").map(Number) as Triple);
  }

  /** Whole block frames of level 0, for the blocks that hold these voxels or all. */
  frames(stream: number, revision: number, of: Triple[] = this.all()): Uint8Array[] {
    const blocks = new Map<string, Triple[]>(of.map((voxel) => [voxel.map((v) => v >> 6).join(","), []]));
    for (const voxel of this.all()) blocks.get(voxel.map((v) => v >> 6).join(","))?.push(voxel);
    return [...blocks].map(([name, voxels]) => blockFrame(stream, revision, name.split(",").map(Number) as Triple, voxels));
  }
}

function blockFrame(stream: number, revision: number, index: Triple, voxels: Triple[]): Uint8Array {
  const chunks = new Map<number, Uint8Array>();
  for (const voxel of voxels) {
    const cell = voxel.map((v) => v & 63) as Triple;
    const chunk = chunkOf(...cell);
    const cells = chunks.get(chunk) ?? new Uint8Array(512);
    cells[bitOf(...cell) >> 3]! |= 1 << (bitOf(...cell) & 7);
    chunks.set(chunk, cells);
  }
  const payload = 28 + 512 * chunks.size;
  const frame = new Uint8Array(HEADER + payload);
  const view = new DataView(frame.buffer);
  view.setUint8(0, 1);
  view.setUint8(1, 2);
  view.setUint32(4, stream, true);
  view.setUint32(8, chunks.size, true);
  view.setUint32(12, payload, true);
  view.setBigUint64(16, BigInt(revision), true);
  index.forEach((i, axis) => view.setInt32(HEADER + 4 * axis, i, true));
  view.setBigUint64(HEADER + 12, 0xffff_ffff_ffff_ffffn, true);
  view.setBigUint64(HEADER + 20, [...chunks.keys()].reduce((bits, chunk) => bits | (1n << BigInt(chunk)), 0n), true);
  [...chunks].sort(([a], [b]) => a - b).forEach(([, cells], i) => frame.set(cells, HEADER + 28 + 512 * i));
  return frame;
}

/** Frames of kind 3: points, metres. */
export function pointsFrame(request: number, points: readonly number[]): Uint8Array {
  const frame = new Uint8Array(HEADER + 4 * points.length);
  const view = new DataView(frame.buffer);
  view.setUint8(0, 3);
  view.setUint32(4, request, true);
  view.setUint32(8, points.length / 3, true);
  view.setUint32(12, 4 * points.length, true);
  points.forEach((p, i) => view.setFloat32(HEADER + 4 * i, p, true));
  return frame;
}

/** An office of 10 x 8 m with a wall of glass nobody has seen, tables and a door. */
export function office(): VoxelMap {
  const map = new VoxelMap();
  const box = (x0: number, y0: number, z0: number, x1: number, y1: number, z1: number, occupied = true): void =>
    void map.fill([x0, y0, z0].map((v) => Math.round(v * 20)) as Triple, [x1, y1, z1].map((v) => Math.round(v * 20) - 1) as Triple, occupied);
  box(-5, -4, -0.05, 5, 4, 0);
  box(-5, -4, 0, 5, -3.9, 2.4);
  box(-5, 3.9, 0, 5, 4, 2.4);
  box(-5, -4, 0, -4.9, 4, 2.4);
  box(4.9, -4, 0, 5, 4, 2.4);
  box(0, -4, 0, 0.1, -1, 2.4);
  box(0, 2.2, 0, 0.1, 4, 2.4);
  box(4.9, -0.5, 0, 5, 0.5, 2.1, false);
  for (const [x, y] of [[-3.6, -2.6], [-3.6, 1.4], [2, -2.8], [2.4, 1.8]] as const) {
    box(x, y, 0.7, x + 1.6, y + 0.8, 0.75);
    for (const [dx, dy] of [[0, 0], [1.5, 0], [0, 0.7], [1.5, 0.7]] as const) box(x + dx, y + dy, 0, x + dx + 0.1, y + dy + 0.1, 0.7);
    box(x + 0.5, y - 0.5, 0.4, x + 1, y, 0.45);
    box(x + 0.5, y - 0.5, 0.45, x + 1, y - 0.4, 0.9);
  }
  box(-4.9, 3.3, 0, -3.4, 3.9, 1.9);
  box(-2, 3.5, 0, -0.5, 3.9, 0.9);
  return map;
}
