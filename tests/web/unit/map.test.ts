import assert from "node:assert/strict";
import { test } from "node:test";
import { BlockStore } from "../../../hmd_bridge/web/src/map/block_store";
import { greedyQuads, quadGeometry, faceAxis, faceLooksUp, QUAD_BYTES, type Quads } from "../../../hmd_bridge/web/src/map/greedy";
import { doJob, packJob, unpackJob, type MeshDone, type MeshJob } from "../../../hmd_bridge/web/src/map/mesh_job";
import { bitOf, chunkOf, keyOf } from "../../../hmd_bridge/web/src/map/lattice";
import { budgetOf, nextRadii } from "../../../hmd_bridge/web/src/map/level_of_detail";
import { Mesher, type MeshWorker } from "../../../hmd_bridge/web/src/map/mesher";
import { raycast } from "../../../hmd_bridge/web/src/map/raycast";
import { RefusedError } from "../../../hmd_bridge/web/src/link/failures";
import { Views, type LookFunction } from "../../../hmd_bridge/web/src/map/views";
import type { Code } from "../../../hmd_bridge/web/generated/messages";
import type { BlockFrame, Triple } from "../../../hmd_bridge/web/src/protocol/frames";
import { random } from "../support/random";

const strides = (size: number): Triple => [1, size + 2, (size + 2) ** 2];
const at = (size: number, [x, y, z]: Triple): number => x + 1 + (y + 1) * (size + 2) + (z + 1) * (size + 2) ** 2;

/** "x,y,z,face" of each face between an occupied cell and an empty neighbour. */
function exposedFaces(cells: Uint8Array, size: number): string[] {
  const faces: string[] = [];
  for (let z = 0; z < size; ++z) for (let y = 0; y < size; ++y) for (let x = 0; x < size; ++x) {
    const cell = at(size, [x, y, z]);
    for (let face = 0; face < 6 && cells[cell]; ++face) {
      const step = strides(size)[faceAxis(face)]! * (faceLooksUp(face) ? 1 : -1);
      if (!cells[cell + step]) faces.push(`${x},${y},${z},${face}`);
    }
  }
  return faces.sort();
}

function coveredFaces({ count, data }: Quads): string[] {
  const faces: string[] = [];
  for (let quad = 0; quad < count; ++quad) {
    const [x, y, z, width, height, face] = data.subarray(quad * QUAD_BYTES) as unknown as [number, number, number, number, number, number];
    const axis = faceAxis(face);
    for (let b = 0; b < height; ++b) for (let a = 0; a < width; ++a) {
      const cell: Triple = [x, y, z];
      cell[(axis + 1) % 3]! += a;
      cell[(axis + 2) % 3]! += b;
      faces.push(`${cell.join(",")},${face}`);
    }
  }
  return faces.sort();
}

test("every exposed face is covered exactly once, and no other, in random volumes", () => {
  for (let seed = 0; seed < 60; ++seed) {
    const next = random(seed);
    const size = 1 + Math.floor(next() * 12);
    const density = next();
    const cells = Uint8Array.from({ length: (size + 2) ** 3 }, () => (next() < density ? 1 : 0));
    assert.deepEqual(coveredFaces(greedyQuads(cells, size)), exposedFaces(cells, size), `seed ${seed}`);
  }
});

test("a full cube is six rectangles; its corners wind outwards", () => {
  const size = 64;
  const cells = new Uint8Array((size + 2) ** 3);
  for (let z = 0; z < size; ++z) for (let y = 0; y < size; ++y) cells.fill(1, at(size, [0, y, z]), at(size, [0, y, z]) + size);
  const quads = greedyQuads(cells, size);
  assert.equal(quads.count, 6);
  const { corners, indices } = quadGeometry(quads);
  for (let triangle = 0; triangle < 12; ++triangle) {
    const [a, b, c] = [0, 1, 2].map((i) => [...corners.subarray(indices[triangle * 3 + i]! * 4, indices[triangle * 3 + i]! * 4 + 4)]) as [number[], number[], number[]];
    const u = [0, 1, 2].map((i) => b[i]! - a[i]!);
    const v = [0, 1, 2].map((i) => c[i]! - a[i]!);
    const normal = [u[1]! * v[2]! - u[2]! * v[1]!, u[2]! * v[0]! - u[0]! * v[2]!, u[0]! * v[1]! - u[1]! * v[0]!];
    const along = normal[faceAxis(a[3]!)]!;
    assert.equal(Math.abs(along), 64 * 64);
    assert.equal(along > 0, faceLooksUp(a[3]!));
  }
});

function blockFrame(index: Triple, cells: Triple[], options: { level?: number; told?: number[] } = {}): BlockFrame {
  const chunks = new Map<number, Uint8Array | null>((options.told ?? []).map((chunk) => [chunk, null]));
  for (const cell of cells) {
    const chunk = chunkOf(...cell);
    const bits = chunks.get(chunk) ?? new Uint8Array(512);
    bits[bitOf(...cell) >> 3]! |= 1 << (bitOf(...cell) & 7);
    chunks.set(chunk, bits);
  }
  return { kind: "block", stream: 0, level: options.level ?? 0, revision: 1, index, chunks: [...chunks].map(([chunk, bits]) => ({ chunk, cells: bits })) };
}

test("a block store holds what the frames said last, and says what to draw anew", () => {
  const store = new BlockStore();
  store.apply(blockFrame([0, 0, 0], [[63, 0, 0], [1, 2, 3]]));
  store.apply(blockFrame([1, 0, 0], [[0, 0, 0]]));
  assert.deepEqual(store.takeDirty().map(({ index }) => index[0]).sort(), [0, 1]);
  assert(store.occupied([1, 2, 3]) && store.occupied([63, 0, 0]) && store.occupied([64, 0, 0]) && !store.occupied([2, 2, 3]));

  // A chunk that is told empty goes; others stay.
  store.apply(blockFrame([0, 0, 0], [], { told: [0] }));
  assert(!store.occupied([1, 2, 3]) && store.occupied([63, 0, 0]));
  assert.deepEqual(store.takeDirty().map(({ index }) => index[0]).sort(), [0, 1], "the neighbour's hidden faces may show now");

  store.apply({ kind: "forget", stream: 0, level: 0, blocks: [[0, 0, 0], [9, 9, 9]] });
  assert.equal(store.size, 1);
  assert.equal(store.takeDirty().length, 2);
  store.apply(blockFrame([1, 0, 0], [], { told: [0] }));
  assert.equal(store.size, 0, "an empty block is none");
});

test("receiving blocks twice, or again after everything was dropped, gives the same", () => {
  const next = random(7);
  const frames = Array.from({ length: 20 }, () => {
    const pick = () => Math.floor(next() * 64);
    return blockFrame([Math.floor(next() * 3), 0, -1], Array.from({ length: 30 }, (): Triple => [pick(), pick(), pick()]));
  });
  const content = (store: BlockStore) => [...store.all()].map((block) => [block.key, [...block.chunks].sort(([a], [b]) => a - b)]).sort();
  const once = new BlockStore();
  frames.forEach((frame) => once.apply(frame));
  const again = new BlockStore();
  frames.forEach((frame) => (again.apply(frame), again.apply(frame)));
  assert.deepEqual(content(again), content(once));
  again.clear();
  assert.equal(again.size, 0);
  assert.equal(again.bounds(), null);
  frames.forEach((frame) => again.apply(frame));
  assert.deepEqual(content(again), content(once));
});

test("coarse cells answer for all their voxels, below zero too", () => {
  const store = new BlockStore();
  store.apply(blockFrame([-1, 0, 0], [[63, 0, 0]], { level: 2 }));
  for (const x of [-4, -3, -1]) assert(store.occupied([x, 3, 0]), `${x}`);
  assert(!store.occupied([-5, 0, 0]) && !store.occupied([0, 0, 0]) && !store.occupied([-1, 4, 0]));
  assert.deepEqual(store.bounds(), { low: [-64, 0, 0], high: [0, 64, 64] });
});

test("no two blocks have the same key", () => {
  const keys = new Set<number>();
  const indices = [-32768, -1, 0, 1, 32767];
  for (let level = 0; level < 6; ++level) for (const x of indices) for (const y of indices) for (const z of indices) keys.add(keyOf(level, [x, y, z]));
  assert.equal(keys.size, 6 * 125);
  assert([...keys].every(Number.isSafeInteger));
});

test("a packed block meshes as its cells do, with its neighbours' faces hidden", () => {
  const store = new BlockStore();
  const next = random(3);
  const pick = (): Triple => [0, 0, 0].map(() => Math.floor(next() * 64)) as Triple;
  for (const index of [[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]] as Triple[]) {
    store.apply(blockFrame(index, Array.from({ length: 20000 }, pick)));
  }
  const job = packJob(5, store.find(0, [0, 0, 0])!, (index) => store.find(0, index));
  const cells = unpackJob(job);
  for (let z = -1; z <= 64; ++z) for (let y = -1; y <= 64; ++y) for (let x = -1; x <= 64; ++x) {
    const outside = [x, y, z].filter((i) => i < 0 || i > 63).length;
    if (outside < 2) assert.equal(cells[at(64, [x, y, z])] === 1, store.occupied([x, y, z]), `${x} ${y} ${z}`);
  }
  assert.equal(doJob(job).indices.length, greedyQuads(cells, 64).count * 6);
});

test("rays meet the first voxel, along axes too", () => {
  const solid = new Set(["5,0,0", "0,-3,0", "4,4,4"]);
  const occupied = (voxel: Triple): boolean => solid.has(voxel.join(","));
  const hit = raycast(occupied, [0.05, 0.05, 0.05], [1, 0, 0], 0.1, 10)!;
  assert.deepEqual([hit.voxel, hit.normal], [[5, 0, 0], [-1, 0, 0]]);
  assert(Math.abs(hit.point[0] - 0.5) < 1e-9);
  assert.deepEqual(raycast(occupied, [0.05, 0.05, 0.05], [0, -1, 0], 0.1, 10)!.normal, [0, 1, 0]);
  const s = 1 / Math.sqrt(3);
  assert.deepEqual(raycast(occupied, [-1, -1, -1], [s, s, s], 0.1, 10)!.voxel, [4, 4, 4]);
  assert.equal(raycast(occupied, [0.05, 0.05, 0.05], [0, 0, 1], 0.1, 10), null);
  assert.equal(raycast(occupied, [0.05, 0.05, 0.05], [1, 0, 0], 0.1, 0.2), null, "out of reach");
});

test("radii shrink over the budget, grow below half of it, and rest between", () => {
  const budget = budgetOf("OculusBrowser Quest 3");
  assert.equal(budget.triangles, 1_000_000);
  assert.deepEqual(nextRadii(budget, budget.radii, 1_200_000), [6.4, 16, 48]);
  assert.deepEqual(nextRadii(budget, [6.4, 16, 48], 700_000), [6.4, 16, 48]);
  assert.deepEqual(nextRadii(budget, [6.4, 16, 48], 10), [7, 17.6, 52.8]);
  let radii = budget.radii;
  for (let i = 0; i < 50; ++i) radii = nextRadii(budget, radii, 1e9);
  assert(radii[0]! > 0.5);
});

test("of a block that changes while it waits only the newest is meshed", () => {
  const posted: MeshJob[] = [];
  const worker: MeshWorker = { onmessage: null, postMessage: (job) => void posted.push(job) };
  const mesher = new Mesher([worker]);
  const finish = (): void => worker.onmessage!({ data: { job: posted.at(-1)!.job, corners: new Uint8Array(), indices: new Uint32Array() } } as MessageEvent<MeshDone>);
  const job = (mark: number) => ({ chunks: Uint8Array.of(mark), cells: new Uint8Array(512), borders: new Uint8Array(3072) });
  const done: string[] = [];
  mesher.mesh("a", () => job(1), () => done.push("a1"));
  mesher.mesh("b", () => job(2), () => done.push("b2"));
  mesher.mesh("b", () => job(3), () => done.push("b3"));
  mesher.mesh("c", () => null, () => done.push("c gone"));
  finish();
  assert.deepEqual(posted.map(({ chunks }) => chunks[0]), [1, 3]);
  finish();
  assert.deepEqual(done, ["a1", "b3", "c gone"]);
  assert(mesher.settled);
});

test("a layer that the server does not have yet is asked for again until it has, or nobody looks", async () => {
  const turn = (): Promise<void> => new Promise((resolve) => setImmediate(resolve));
  const later: (() => void)[] = [];
  let code: Code | null = "UNAVAILABLE";
  let asked = 0;
  const look = (() => {
    ++asked;
    return code === null ? Promise.resolve({ stream: 3, blocks: 0, lacking: 0 }) : Promise.reject(new RefusedError({ code, message: "", retry: true } as never));
  }) as unknown as LookFunction;
  const views = new Views(look, () => Promise.resolve(), (task) => later.push(task));
  const view = views.open("labels");
  view.show({ frame: "map", centre: [0, 0, 0], radii: [5] });
  await turn();
  assert.equal(view.stream, null);
  later.shift()!();
  await turn();
  code = null;
  later.shift()!();
  await turn();
  assert.equal(view.stream, 3);
  assert.equal(asked, 3);
  assert.equal(later.length, 0);
  code = "NO_AGENT";
  views.renew(false);
  await turn();
  view.hide();
  later.shift()!();
  await turn();
  assert.equal(asked, 4, "nobody looks any more");
  code = "BAD_REQUEST";
  view.show({ frame: "map", centre: [0, 0, 0], radii: [5] });
  await turn();
  assert.equal(later.length, 0, "it will not come");
});
