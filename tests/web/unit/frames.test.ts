import "../support/raw_deflate";
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { FrameError, HEADER_BYTES, inflate, meshFrame, meshPayload, packPayload, readFrame, readHeader, type RoomMesh } from "../../../hmd_bridge/web/src/protocol/frames";
import { checkAnswer, checkEvent, checkNotice, checkRequest } from "../../../hmd_bridge/web/generated/messages";
import { answerTo, readText, TextError } from "../../../hmd_bridge/web/src/protocol/envelope";
import { goldenFolder } from "../support/paths";

interface FrameRow { name: string; good: boolean; kind: number; hex: string; payload: string }
interface MessageRow { what: "request" | "answer" | "notice" | "event"; name: string; good: boolean; body: unknown }

const rows = JSON.parse(readFileSync(join(goldenFolder, "frames.json"), "utf8")) as FrameRow[];
const bytesOf = (hex: string): Uint8Array<ArrayBuffer> => new Uint8Array(Buffer.from(hex, "hex"));
const fromServer = (row: FrameRow): boolean => row.kind < 64;
const named = async (name: string) => readFrame(bytesOf(rows.find((row) => row.name === name)!.hex));

test("golden frames of a server are read, bad ones refused", async () => {
  for (const row of rows.filter(fromServer)) {
    if (row.good) await assert.doesNotReject(readFrame(bytesOf(row.hex)), row.name);
    else await assert.rejects(readFrame(bytesOf(row.hex)), FrameError, row.name);
  }
});

test("a block's chunks are what the golden bytes say, deflated or not", async () => {
  const block = await named("block");
  assert.deepEqual(await named("block, deflated"), block);
  assert(block.kind === "block");
  assert.deepEqual([block.level, block.index, block.revision], [2, [-2, 0, 1], 57]);
  assert.deepEqual(block.chunks.map(({ chunk, cells }) => [chunk, cells !== null]), [[0, false], [5, true], [63, true]]);
  assert.deepEqual([block.chunks[1]!.cells![0], block.chunks[1]!.cells![511]], [1, 0x80]);
  const whole = await named("block, whole");
  assert(whole.kind === "block");
  assert.deepEqual([whole.chunks.length, whole.revision], [64, 2 ** 40]);
});

test("forget, points, cells and labels are what the golden bytes say", async () => {
  assert.deepEqual(await named("forget"), { kind: "forget", stream: 0, level: 1, blocks: [[-2, 0, 1], [7, 8, -9]] });
  const points = await named("points");
  assert(points.kind === "points");
  assert.deepEqual([points.request, ...points.points], [12, 0.25, -1.5, 2, 1000, 0, -0.125]);
  const cells = await named("cells");
  assert(cells.kind === "cells");
  assert.deepEqual([cells.low, cells.size, [...cells.cells]], [[-4, 10], [5, 1], [2, 0, 1, 2, 1]]);
  const labels = await named("labels");
  assert(labels.kind === "labels");
  assert.deepEqual(labels.runs, [{ start: 128, length: 3, thing: 0 }, { start: 131, length: 1, thing: 1 }]);
});

test("frames cut anywhere are refused, never misread", async () => {
  for (const row of rows.filter((each) => each.good && fromServer(each))) {
    const bytes = bytesOf(row.hex);
    for (let end = 0; end < bytes.length; end += end < 64 ? 1 : 97) await assert.rejects(readFrame(bytes.slice(0, end)), FrameError, `${row.name} at ${end}`);
  }
});

test("a frame that inflates to more than it says is refused", async () => {
  const bytes = bytesOf(rows.find((row) => row.name === "block, deflated")!.hex);
  new DataView(bytes.buffer).setUint32(12, 100, true);
  await assert.rejects(readFrame(bytes), FrameError);
});

test("mesh frames are written as the golden ones", async () => {
  const triangle: RoomMesh = { number: 9, vertices: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), triangles: Uint32Array.of(0, 1, 2) };
  const gone: RoomMesh = { number: 9, vertices: new Float32Array(), triangles: new Uint32Array() };
  const sensor = [1, 2, 1.5, 0, 0, 0, 1] as const;
  const cases: [string, RoomMesh[], number, number][] = [["mesh", [triangle], 14, 0], ["mesh that is gone", [gone], 15, 1], ["an empty look", [], 16, 2]];
  for (const [name, meshes, id, sequence] of cases) {
    const row = rows.find((each) => each.name === name)!;
    const frame = meshFrame(id, sequence, meshes.length, await packPayload(meshPayload([...sensor], meshes)));
    const golden = bytesOf(row.hex);
    const header = (bytes: Uint8Array) => [bytes[0], ...bytes.slice(2, HEADER_BYTES)];
    assert.deepEqual(header(frame), header(golden), name);
    const body = frame.slice(HEADER_BYTES);
    const payload = frame[1]! & 1 ? await inflate(body, 1 << 20) : body;
    assert.equal(Buffer.from(payload).toString("hex"), row.payload, name);
  }
});

test("a header is refused for a client's kind", () => {
  assert.throws(() => readHeader(bytesOf(rows.find((row) => row.name === "mesh")!.hex)), FrameError);
});

test("golden messages pass and fail as they should", () => {
  const messages = JSON.parse(readFileSync(join(goldenFolder, "messages.json"), "utf8")) as MessageRow[];
  const checks = { request: checkRequest, answer: checkAnswer, notice: checkNotice, event: checkEvent };
  for (const { what, name, good, body } of messages) {
    const problem = checks[what](name, body);
    assert.equal(problem === null, good, `${what} ${name}: ${problem ?? "passed"}: ${JSON.stringify(body).slice(0, 200)}`);
  }
});

test("envelopes are told apart; what is none of them is refused", () => {
  assert.deepEqual(readText('{"id":3,"answer":{}}'), { what: "answer", id: 3, fields: {} });
  assert.equal(readText('{"id":3,"error":{"code":"BUSY","message":"later","retry":true}}').what, "error");
  assert.equal(readText('{"event":"agents","body":{"agents":[]}}').what, "event");
  for (const text of ["", "[]", "null", "{}", '{"id":"3","answer":{}}', '{"id":1,"error":{"code":"NO_SUCH"}}', '{"event":"agents","body":{}}', '{"event":"nothing","body":{}}']) {
    assert.throws(() => readText(text), TextError, text);
  }
  assert.throws(() => answerTo("undo", { revision: -1, voxels: 0 }), TextError);
});
