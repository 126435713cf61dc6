/** Binary frames of hmd.v1, byte by byte as PROTOCOL.md lays them out: those of the server are read, those of a client written. */

export const HEADER_BYTES = 24;
export const CHUNK_BYTES = 512;
const MAX_PAYLOAD = 16 * 1024 * 1024;
const MAX_LEVEL = 5;
const DEFLATED = 1;
const WHOLE = 2;

export type Triple = [number, number, number];

export interface FrameHeader {
  kind: number;
  deflated: boolean;
  whole: boolean;
  level: number;
  /** The stream of blocks, or the id of the request that this frame belongs to. */
  stream: number;
  count: number;
  payloadBytes: number;
  revision: number;
}

export interface BlockFrame {
  kind: "block";
  stream: number;
  level: number;
  revision: number;
  index: Triple;
  /** Chunk numbers x + 4 y + 16 z that this frame speaks of, and their cells: null for an empty one. */
  chunks: { chunk: number; cells: Uint8Array | null }[];
}
export interface ForgetFrame {
  kind: "forget";
  stream: number;
  level: number;
  blocks: Triple[];
}
export interface PointsFrame {
  kind: "points";
  request: number;
  points: Float32Array;
}
export interface CellsFrame {
  kind: "cells";
  request: number;
  low: [number, number];
  size: [number, number];
  /** 0 unknown, 1 free, 2 occupied; x fastest. */
  cells: Uint8Array;
}
export interface LabelledRun {
  start: number;
  length: number;
  thing: number;
}
export interface LabelsFrame {
  kind: "labels";
  stream: number;
  level: number;
  index: Triple;
  things: { label: number; instance: number }[];
  /** Voxels of the block in the order x + 64 y + 4096 z. */
  runs: LabelledRun[];
}
export type ServerFrame = BlockFrame | ForgetFrame | PointsFrame | CellsFrame | LabelsFrame;

export class FrameError extends Error {}

function refuse(what: string): never {
  throw new FrameError(what);
}

/** @throws FrameError */
export function readHeader(bytes: Uint8Array): FrameHeader {
  if (bytes.length < HEADER_BYTES) refuse("a frame is shorter than its header");
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const kind = view.getUint8(0);
  const flags = view.getUint8(1);
  const level = view.getUint8(2);
  if (kind < 1 || kind > 5) refuse(`no frame of a server is of kind ${kind}`);
  if (flags & ~(DEFLATED | WHOLE)) refuse("a frame has unknown flags");
  if (flags & WHOLE && kind !== 1) refuse("only a block can be whole");
  if (level > MAX_LEVEL) refuse(`there is no level ${level}`);
  if (view.getUint8(3) !== 0) refuse("a reserved byte is not 0");
  const payloadBytes = view.getUint32(12, true);
  if (payloadBytes > MAX_PAYLOAD) refuse("a frame is too large");
  return {
    kind,
    deflated: (flags & DEFLATED) !== 0,
    whole: (flags & WHOLE) !== 0,
    level,
    stream: view.getUint32(4, true),
    count: view.getUint32(8, true),
    payloadBytes,
    revision: Number(view.getBigUint64(16, true)),
  };
}

/** Takes a payload in order; refuses to go beyond its end. */
class Reader {
  private at = 0;
  private readonly view: DataView;
  constructor(private readonly bytes: Uint8Array) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }
  private skip(bytes: number): number {
    if (bytes > this.bytes.length - this.at) refuse("a frame ends early");
    const at = this.at;
    this.at += bytes;
    return at;
  }
  i32(): number {
    return this.view.getInt32(this.skip(4), true);
  }
  u32(): number {
    return this.view.getUint32(this.skip(4), true);
  }
  u64(): bigint {
    return this.view.getBigUint64(this.skip(8), true);
  }
  triple(): Triple {
    return [this.i32(), this.i32(), this.i32()];
  }
  take(bytes: number): Uint8Array {
    const at = this.skip(bytes);
    return this.bytes.slice(at, at + bytes);
  }
  varint(): number {
    let value = 0;
    for (let shift = 0; shift < 35; shift += 7) {
      const byte = this.view.getUint8(this.skip(1));
      value += (byte & 0x7f) * 2 ** shift;
      if (byte < 0x80) return value;
    }
    return refuse("a number goes on too long");
  }
  end(): void {
    if (this.at !== this.bytes.length) refuse("a frame goes on after its end");
  }
}

function readBlock(header: FrameHeader, reader: Reader): BlockFrame {
  const index = reader.triple();
  const told = reader.u64();
  const filled = reader.u64();
  if (filled & ~told) refuse("a block fills chunks that it does not speak of");
  if (header.whole && told !== 0xffff_ffff_ffff_ffffn) refuse("a whole block does not speak of all its chunks");
  const chunks: BlockFrame["chunks"] = [];
  let count = 0;
  for (let chunk = 0; chunk < 64; ++chunk) {
    const bit = 1n << BigInt(chunk);
    if (!(told & bit)) continue;
    const full = (filled & bit) !== 0n;
    if (full) ++count;
    chunks.push({ chunk, cells: full ? reader.take(CHUNK_BYTES) : null });
  }
  if (count !== header.count) refuse("a block holds another number of chunks than it says");
  return { kind: "block", stream: header.stream, level: header.level, revision: header.revision, index, chunks };
}

function readForget(header: FrameHeader, reader: Reader): ForgetFrame {
  if (header.payloadBytes !== header.count * 12) refuse("a forget frame has another size than it says");
  const blocks = Array.from({ length: header.count }, () => reader.triple());
  return { kind: "forget", stream: header.stream, level: header.level, blocks };
}

function readPoints(header: FrameHeader, reader: Reader): PointsFrame {
  if (header.payloadBytes !== header.count * 12) refuse("a points frame has another size than it says");
  const points = new Float32Array(reader.take(header.payloadBytes).buffer);
  if (!points.every(Number.isFinite)) refuse("a point is no number");
  return { kind: "points", request: header.stream, points };
}

function readCells(header: FrameHeader, reader: Reader): CellsFrame {
  const low: [number, number] = [reader.i32(), reader.i32()];
  const size: [number, number] = [reader.i32(), reader.i32()];
  if (size[0] < 0 || size[1] < 0 || size[0] * size[1] !== header.count) refuse("a grid has another size than it says");
  if (header.payloadBytes !== 16 + Math.ceil(header.count / 4)) refuse("a cells frame has another size than it says");
  const packed = reader.take(Math.ceil(header.count / 4));
  const cells = Uint8Array.from({ length: header.count }, (_, i) => (packed[i >> 2]! >> (2 * (i & 3))) & 3);
  return { kind: "cells", request: header.stream, low, size, cells };
}

function readLabels(header: FrameHeader, reader: Reader): LabelsFrame {
  const index = reader.triple();
  const thingCount = reader.u32();
  if (thingCount * 8 > header.payloadBytes) refuse("a labels frame ends early");
  const things = Array.from({ length: thingCount }, () => ({ label: reader.u32(), instance: reader.u32() }));
  const runCount = reader.u32();
  if (runCount * 3 > header.payloadBytes) refuse("a labels frame ends early");
  const runs: LabelledRun[] = [];
  let at = 0;
  for (let i = 0; i < runCount; ++i) {
    const start = at + reader.varint();
    const length = reader.varint();
    const thing = reader.varint();
    at = start + length;
    if (length === 0 || at > 64 ** 3 || thing >= thingCount) refuse("a labels frame has a run that cannot be");
    runs.push({ start, length, thing });
  }
  return { kind: "labels", stream: header.stream, level: header.level, index, things, runs };
}

/** @param payload inflated. @throws FrameError */
export function readPayload(header: FrameHeader, payload: Uint8Array): ServerFrame {
  if (payload.length !== header.payloadBytes) refuse("a frame has another size than it says");
  const reader = new Reader(payload);
  const read = [readBlock, readForget, readPoints, readCells, readLabels][header.kind - 1]!;
  const frame = read(header, reader);
  reader.end();
  return frame;
}

async function collect(stream: ReadableStream<Uint8Array>, atMost: number): Promise<Uint8Array> {
  const parts: Uint8Array[] = [];
  let size = 0;
  const reader = stream.getReader();
  for (let next = await reader.read(); !next.done; next = await reader.read()) {
    size += next.value.length;
    if (size > atMost) {
      await reader.cancel();
      refuse("a frame is larger than it says");
    }
    parts.push(next.value);
  }
  const all = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}

/** Raw deflate, RFC 1951. */
export async function inflate(bytes: Uint8Array<ArrayBuffer>, atMost: number): Promise<Uint8Array> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  try {
    return await collect(stream, atMost);
  } catch (error) {
    return error instanceof FrameError ? Promise.reject(error) : refuse("a frame cannot be inflated");
  }
}

export function deflate(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array> {
  return collect(new Blob([bytes]).stream().pipeThrough(new CompressionStream("deflate-raw")), MAX_PAYLOAD);
}

/** Rejects with FrameError. */
export async function readFrame(bytes: Uint8Array<ArrayBuffer>): Promise<ServerFrame> {
  const header = readHeader(bytes);
  const body = bytes.subarray(HEADER_BYTES);
  return readPayload(header, header.deflated ? await inflate(body, header.payloadBytes) : body);
}

/** A mesh of the room in the own frame; without vertices it is gone. */
export interface RoomMesh {
  number: number;
  /** x y z of each, metres. */
  vertices: Float32Array;
  triangles: Uint32Array;
}

/** Position x y z, quaternion x y z w. */
export type SensorPose = [number, number, number, number, number, number, number];

export function meshPayload(sensor: SensorPose, meshes: readonly RoomMesh[]): Uint8Array<ArrayBuffer> {
  const size = meshes.reduce((sum, mesh) => sum + 12 + 4 * (mesh.vertices.length + mesh.triangles.length), 28);
  const bytes = new Uint8Array(size);
  const view = new DataView(bytes.buffer);
  let at = 0;
  const f32 = (value: number): void => view.setFloat32((at += 4) - 4, value, true);
  const u32 = (value: number): void => view.setUint32((at += 4) - 4, value, true);
  sensor.forEach(f32);
  for (const mesh of meshes) {
    u32(mesh.number);
    u32(mesh.vertices.length / 3);
    u32(mesh.triangles.length / 3);
    mesh.vertices.forEach(f32);
    mesh.triangles.forEach(u32);
  }
  return bytes;
}

const KIND_MESH = 65;

/** A payload that is on its way into a frame. */
export interface PackedPayload {
  deflated: boolean;
  body: Uint8Array;
  /** Bytes, inflated. */
  size: number;
}

/** Deflates where that makes it smaller. */
export async function packPayload(payload: Uint8Array<ArrayBuffer>): Promise<PackedPayload> {
  const body = await deflate(payload);
  return body.length < payload.length ? { deflated: true, body, size: payload.length } : { deflated: false, body: payload, size: payload.length };
}

/** @param meshes how many there are in the payload */
export function meshFrame(request: number, sequence: number, meshes: number, { deflated, body, size }: PackedPayload): Uint8Array<ArrayBuffer> {
  const frame = new Uint8Array(HEADER_BYTES + body.length);
  const view = new DataView(frame.buffer);
  view.setUint8(0, KIND_MESH);
  view.setUint8(1, deflated ? DEFLATED : 0);
  view.setUint32(4, request, true);
  view.setUint32(8, meshes, true);
  view.setUint32(12, size, true);
  view.setBigUint64(16, BigInt(sequence), true);
  frame.set(body, HEADER_BYTES);
  return frame;
}
